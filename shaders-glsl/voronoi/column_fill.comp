// Coloring, 3 of 6: for each pixel the row of the nearest site in its column, the lower one of two; one invocation for
// each column of each band of rows.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 grid;
    ReadU32 ends;
    U32 nearest;
    uint width;
    uint height;
    uint band; // rows
};

void main() {
    uint item = item_index();
    uint x = item % width;
    uint number = item / width;
    uint from = number * band;
    if (from >= height) {
        return;
    }
    uint to = min(from + band, height);
    uint bands = (height + band - 1u) / band;
    // The last site of the bands below, the first of those above.
    uint below = NONE;
    for (uint b = number; b > 0u && below == NONE; b--) {
        uint found = ends.at[(b - 1u) * width + x] >> 16;
        below = found == 0xffffu ? NONE : found;
    }
    uint above = NONE;
    for (uint b = number + 1u; b < bands && above == NONE; b++) {
        uint found = ends.at[b * width + x] & 0xffffu;
        above = found == 0xffffu ? NONE : found;
    }
    for (uint y = from; y < to; y++) {
        below = grid.at[y * width + x] != NONE ? y : below;
        nearest.at[y * width + x] = below;
    }
    for (uint y = to; y > from;) {
        y--;
        below = nearest.at[y * width + x];
        if (below == y) {
            above = y;
        } else if (above != NONE && (below == NONE || above - y < y - below)) {
            nearest.at[y * width + x] = above;
        }
    }
}
