// The sum over each tile of f(word): the first of the three kernels of a scan.
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "tile.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 words;
    WriteU32 sums;
    MaybeReadU32 counter;
    uint limit;
};

void main() {
    uint tile = group_index();
    uint end = length_of(counter, limit);
    if (tile * TILE >= end) {
        return;
    }
    uint sum = 0u;
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        uvec4 found = f(load4(words, tile_place(tile, j), end));
        sum += found.x + found.y + found.z + found.w;
    }
    uint total;
    sum_before_subgroup(subgroupAdd(sum), total);
    if (rank_in_group() == 0u) {
        sums.at[tile] = total;
    }
}
