// Debris, 2 of 3: takes the color from what the last round marked, the last of the debris; neighbors that had the same
// color become candidates, once each.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    U32 colors;
    U32 state; // bit 0 debris, bit 1 candidate
    ReadU32 debris;
    ReadU32 total;
    ReadU32 marked;
    WriteU32 candidates;
    U32 count;
    uint width;
    uint height;
};

void main() {
    uint i = item_index();
    if (i >= marked.at[0]) {
        return;
    }
    uint index = debris.at[total.at[0] - marked.at[0] + i];
    uint pixel = pixel_at(index, width);
    uint color = atomicExchange(colors.at[index], UNCOLORED);
    for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, width, height);
        if (other == NONE) {
            continue;
        }
        uint there = index_of(other, width);
        // A neighbor that loses its color at the same time may be met before or after; it is debris and no candidate.
        if (atomicOr(colors.at[there], 0u) == color && atomicOr(state.at[there], 2u) == 0u) {
            candidates.at[atomicAdd(count.at[0], 1u)] = there;
        }
    }
}
