// Debris, 3 of 3: marks those candidates that have lost their last closer neighbor of their own color.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "closer.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 sites;
    WriteU32 state;
    WriteU32 debris;
    U32 total;
    U32 marked;
    ReadU32 candidates;
    ReadU32 count;
    uint width;
    uint height;
};

void main() {
    uint i = item_index();
    if (i >= count.at[0]) {
        return;
    }
    uint index = candidates.at[i];
    bool keeps = has_closer(colors, sites, index, width, height);
    state.at[index] = keeps ? 0u : 1u;
    if (!keeps) {
        debris.at[atomicAdd(total.at[0], 1u)] = index;
        atomicAdd(marked.at[0], 1u);
    }
}
