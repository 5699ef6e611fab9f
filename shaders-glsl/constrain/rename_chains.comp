// Chains in other names.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 words;
    ReadU32 names;
    U32 chains;
    uint limit; // of vertices in chains
    uint vertices;
};

void main() {
    uint count = min(words.at[CHAINED], limit);
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint v = chains.at[i];
        chains.at[i] = v < vertices ? names.at[v] : v;
    }
}
