// Walks that are begun again, 2 of 3: each vertex between the ends of a chosen constraint, and exactly on it, falls in a bucket
// of those along it. The least of each is where a piece begins.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"
#include "steps.glsl"
#include "cells.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32x2 ends;
    ReadU32 spokes;
    ReadU32 met;
    U32x4 pieces;
    U32 words;
    int64_t low_x;
    int64_t low_y;
    int exponent; // of places finer than those of cells
    uint vertices;
};

void main() {
    uint count = words.at[CHOSEN];
    uint buckets = words.at[BUCKETS];
    for (uint v = item_index(); v < vertices; v += item_stride()) {
        if (count == 0u || spokes.at[v] == NONE) {
            continue;
        }
        Point p = point_at(positions, v);
        for (uint slot = 0u; slot < count; slot++) {
            uint c = words.at[CHOSEN_LIST + slot];
            uvec2 both = (met.at[c] & REVERSED) != 0u ? ends.at[c].yx : ends.at[c];
            Point a = point_at(positions, both.x);
            Point b = point_at(positions, both.y);
            if (orient2d(a, b, p) != 0 || !lies_ahead(a, p, a, b) || !lies_ahead(p, b, a, b)) {
                continue;
            }
            i64vec2 from = place_of(a, exponent, low_x, low_y);
            i64vec2 across = abs(place_of(b, exponent, low_x, low_y) - from);
            i64vec2 along = abs(place_of(p, exponent, low_x, low_y) - from);
            int64_t length = max(max(across.x, across.y), int64_t(1));
            int64_t bucket = (across.x >= across.y ? along.x : along.y) * int64_t(buckets) / length;
            uint place = words.at[CHOSEN_RUN] + slot * buckets + uint(min(bucket, int64_t(buckets - 1u)));
            if (atomicMin(pieces.at[place].z, AT_VERTEX | v) == NO_PIECE) {
                atomicAdd(words.at[CHOSEN_FOUND + slot], 1u);
            }
        }
    }
}
