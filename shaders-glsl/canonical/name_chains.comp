// The vertices along constraints get their names; and chains with a vertex between their ends are counted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

#extension GL_KHR_shader_subgroup_ballot : require

layout(push_constant, std430) uniform Args {
    ReadU32 names;
    ReadU32 starts; // by constraint, and one more: where its chain begins
    U32 chains;
    U32 through;
    MaybeReadU32 counter; // of vertices in chains
    uint limit;
    uint constraints;
    uint count; // of vertices
};

void main() {
    uint i = item_index();
    if (i < length_of(counter, limit)) {
        uint v = chains.at[i];
        chains.at[i] = v < count ? names.at[v] : NONE;
    }
    bool passes = i < constraints && starts.at[i + 1u] - starts.at[i] > 2u;
    uint found = subgroupBallotBitCount(subgroupBallot(passes));
    if (found != 0u && subgroupElect()) {
        atomicAdd(through.at[0], found);
    }
}
