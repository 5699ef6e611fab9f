// Exclusive scan, 3 of 3: scans each tile, on from the sum of all tiles before it. Output may be input. Where the sums are
// not scanned, it writes the sum of all.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "tile_base.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 words;
    WriteU32 scanned;
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
    uvec4 word[STEPS];
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        word[j] = load4(words, tile_place(tile, j), end);
    }
    uint before[STEPS];
    uint carry = 0u;
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        uint sum = word[j].x + word[j].y + word[j].z + word[j].w;
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
        uvec4 result;
        result.x = base + before[j];
        result.y = result.x + word[j].x;
        result.z = result.y + word[j].y;
        result.w = result.z + word[j].z;
        if (place + 4u <= end) {
            WriteU32x4(scanned).at[place / 4u] = result;
        } else {
            for (uint k = 0u; k < 4u; k++) {
                if (place + k < end) {
                    scanned.at[place + k] = result[k];
                }
            }
        }
    }
}
