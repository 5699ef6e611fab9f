// The canonical place of each triangle: behind those that begin at lower vertices, and behind those of its own list with a
// lower second corner, which no two share. Lists too long for comparing all with all are left to `sort_long`.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 names;
    ReadU32 starts;
    ReadU32 named_starts;
    ReadU32 list;
    ReadU32 keys;
    WriteU32 places;
    WriteU32 long_lists;
    U32 long_count;
    uint count; // of vertices
    uint longest;
};

void main() {
    uint v = item_index();
    if (v >= count) {
        return;
    }
    uint from = starts.at[v];
    uint to = starts.at[v + 1u];
    if (from == to) {
        return;
    }
    if (to - from > longest) {
        long_lists.at[atomicAdd(long_count.at[0], 1u)] = v;
        return;
    }
    uint first = named_starts.at[names.at[v]];
    for (uint p = from; p < to; p++) {
        uint key = keys.at[p];
        uint rank = 0u;
        for (uint q = from; q < to; q++) {
            rank += uint(keys.at[q] < key);
        }
        places.at[list.at[p] / 3u] = first + rank;
    }
}
