// Occupancy, 1 of 2: a bit for each cell that has a point. Of every `every` runs of eight points one is looked at. Also makes
// zeros of the counts.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "cells.glsl"

layout(push_constant, std430) uniform Args {
    ReadU64 points;
    ReadU64 bounds;
    U32 bits; // zeros
    WriteU32 counts;
    uint count;
    uint every;
};

const uint LEVELS = 4u;

shared Cells cells;

void main() {
    uint item = item_index();
    if (item < LEVELS) {
        counts.at[item] = 0u;
    }
    if (gl_LocalInvocationIndex == 0u) {
        cells = cells_of(bounds);
    }
    barrier();
    uint point = item / 8u * 8u * every + item % 8u;
    if (point >= count) {
        return;
    }
    int64_t x = floor_units(points.at[2u * point], cells.exponent) - cells.first.x;
    int64_t y = floor_units(points.at[2u * point + 1u], cells.exponent) - cells.first.y;
    // Within the bounds both are.
    uvec2 cell = uvec2(uint(x), uint(y)) & SIDE - 1u;
    uint word = cell.y * (SIDE / 32u) + (cell.x >> 5);
    uint bit = 1u << (cell.x & 31u);
    // Where many points share a cell most of them need not queue up.
    if ((bits.at[word] & bit) == 0u) {
        atomicOr(bits.at[word], bit);
    }
}
