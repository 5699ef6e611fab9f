// Exclusive scan, 2 of 3: scans the sums of the tiles in place, in one workgroup, and writes the sum of all.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    U32 sums;
    MaybeWriteU32 total;
    MaybeReadU32 counter;
    uint limit;
    uint tile; // words in a tile
};

const uint ITEMS = 8u;

void main() {
    uint end = length_of(counter, limit);
    uint tiles = end / tile + uint(end % tile != 0u);
    uint carry = 0u;
    for (uint first = 0u; first < tiles; first += ITEMS * WORKGROUP) {
        uint place = first + ITEMS * rank_in_group();
        uint value[ITEMS];
        uint sum = 0u;
        [[unroll]] for (uint k = 0u; k < ITEMS; k++) {
            value[k] = place + k < tiles ? sums.at[place + k] : 0u;
            sum += value[k];
        }
        uint all;
        uint before = carry + sum_before(sum, all);
        [[unroll]] for (uint k = 0u; k < ITEMS; k++) {
            if (place + k < tiles) {
                sums.at[place + k] = before;
            }
            before += value[k];
        }
        carry += all;
    }
    if (present(total) && rank_in_group() == 0u) {
        total.at[0] = carry;
    }
}
