// Coloring, 6 of 6: each pixel looks up who wins it: the band among its row's stacks, then the entry.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "row.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 grid;
    ReadU32 nearest;
    ReadU32 entries;
    ReadU32 live;
    ReadU32 starts;
    WriteU32 colors;
    uint width;
    uint height;
    uint band; // columns
};

void main() {
    uint index = item_index();
    if (index >= width * height) {
        return;
    }
    uint y = index / width;
    uint x = index % width;
    uint bands = (width + band - 1u) / band;
    // The last band that starts at or before the pixel; the first stack that is not empty starts at 0.
    uint low = 0u;
    uint high = bands;
    while (low + 1u < high) {
        uint middle = (low + high) / 2u;
        bool at_or_before = starts.at[y * bands + middle] <= x;
        low = at_or_before ? middle : low;
        high = at_or_before ? high : middle;
    }
    uint word = live.at[y * bands + low];
    uint start = y * width + low * band;
    low = word & 0xffu;
    high = word >> 8 & 0xffu;
    while (low + 1u < high) {
        uint middle = (low + high) / 2u;
        bool at_or_before = entries.at[start + middle] >> 16 <= x;
        low = at_or_before ? middle : low;
        high = at_or_before ? high : middle;
    }
    uint column = entries.at[start + low] & 0xffffu;
    colors.at[index] = grid.at[nearest.at[y * width + column] * width + column];
}
