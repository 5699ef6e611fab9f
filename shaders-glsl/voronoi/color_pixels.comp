// Coloring, 7 of 8: the pixels of each tile that is left look up who wins them: the band among their row's stacks, then the
// entry.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "columns.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    ReadU32 ranks;
    ReadU32 nearest;
    ReadU32 entries;
    ReadU32 live;
    ReadU32 starts;
    ReadU32 left;
    ReadU32 left_count;
    WriteU32 colors;
    uint width;
    uint height;
    uint band; // columns
};

uint color_of(uint x, uint y) {
    uint bands = (width + band - 1u) / band;
    // The last band that starts at or before the pixel, mostly its own; the first stack that is not empty starts at 0.
    uint own = x / band;
    uint next = own + 1u < bands ? starts.at[y * bands + own + 1u] : NONE;
    bool before_own = starts.at[y * bands + own] > x;
    uint low = before_own ? 0u : next <= x ? own + 1u : own;
    uint high = before_own ? own : next <= x ? bands : own + 1u;
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
    return number_of(bits, ranks, nearest_row(nearest, column, y, width) << 16 | column, pitch_of(width));
}

void main() {
    if (group_index() >= left_count.at[0]) {
        return;
    }
    uint tile = left.at[group_index()];
    uint across = tiles_across(width);
    for (uint i = gl_LocalInvocationIndex; i < TILE_WIDTH * TILE_HEIGHT; i += WORKGROUP) {
        uint x = tile % across * TILE_WIDTH + i % TILE_WIDTH;
        uint y = tile / across * TILE_HEIGHT + i / TILE_WIDTH;
        if (x < width && y < height) {
            colors.at[y * width + x] = color_of(x, y);
        }
    }
}
