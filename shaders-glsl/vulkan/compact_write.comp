// Stream compaction, 3 of 3: writes what is flagged, in order: values, or without them indices. Where the
// sums are not scanned, it writes how many there are.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "tile_base.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 flags;
    MaybeReadU32 values;
    WriteU32 kept;
    ReadU32 sums;
    MaybeWriteU32 total;
    MaybeReadU32 counter;
    uint limit;
};

void main() {
    uint tile = group_index();
    uint end = length_of(counter, limit);
    if (tile * TILE >= end) {
        if (RAW != 0u && tile == 0u && present(total) && rank_in_group() == 0u) {
            total.at[0] = 0u;
        }
        return;
    }
    uvec4 flag[STEPS];
    uint before[STEPS];
    uint carry = 0u;
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        flag[j] = min(load4(flags, tile_place(tile, j), end), uvec4(1u));
        uint sum = flag[j].x + flag[j].y + flag[j].z + flag[j].w;
        before[j] = carry + subgroupExclusiveAdd(sum);
        carry += subgroupAdd(sum);
    }
    uint before_tile = sum_before_tile(sums, tile);
    uint in_tile;
    uint base = before_tile + sum_before_subgroup(carry, in_tile);
    if (RAW != 0u && is_last_tile(tile, end) && present(total) && rank_in_group() == 0u) {
        total.at[0] = before_tile + in_tile;
    }
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        uint place = tile_place(tile, j);
        uint to = base + before[j];
        [[unroll]] for (uint k = 0u; k < 4u; k++) {
            if (flag[j][k] != 0u) {
                kept.at[to] = present(values) ? values.at[place + k] : place + k;
                to++;
            }
        }
    }
}
