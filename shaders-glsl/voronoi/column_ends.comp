// Coloring, 3 of 8: the first and the last row with a site, in each column of each band of rows; a half word each.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    WriteU32 ends;
    uint width;
    uint height;
    uint band; // rows
};

void main() {
    uint item = item_index();
    uint x = item % width;
    uint from = item / width * band;
    if (from >= height) {
        return;
    }
    uint pitch = pitch_of(width);
    uint first = 0xffffu;
    uint last = 0xffffu;
    for (uint y = from; y < min(from + band, height); y++) {
        if ((bits.at[y * pitch + (x >> 5)] >> (x & 31u) & 1u) != 0u) {
            first = first == 0xffffu ? y : first;
            last = y;
        }
    }
    ends.at[item] = last << 16 | first;
}
