// The vertex of each input point that does not stand for itself; and how many vertices there are not, counted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

#extension GL_KHR_shader_subgroup_ballot : require

layout(push_constant, std430) uniform Args {
    ReadU32 vertex_of;
    ReadU32 order;
    ReadU32 names;
    WriteU32 representatives;
    U32 duplicates;
    uint count;
};

void main() {
    uint i = item_index();
    bool duplicate = false;
    if (i < count) {
        uint v = vertex_of.at[i];
        uint own = order.at[i];
        uint name = v < count ? names.at[v] : own;
        if (name != own) {
            representatives.at[own] = name;
        }
        duplicate = v != i;
    }
    uvec4 ballot = subgroupBallot(duplicate);
    uint found = subgroupBallotBitCount(ballot);
    if (found != 0u && subgroupElect()) {
        atomicAdd(duplicates.at[0], found);
    }
}
