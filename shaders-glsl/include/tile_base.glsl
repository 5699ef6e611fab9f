// What comes before a tile: the scanned sums say it, or, where RAW, each workgroup adds up the sums of the tiles before its
// own. That is cheap as long as there are not many, and saves the kernel that scans them.
#ifndef TILE_BASE_GLSL
#define TILE_BASE_GLSL

#include "tile.glsl"
#include "workgroup_scan.glsl"

layout(constant_id = 1) const uint RAW = 0u;

uint sum_before_tile(ReadU32 sums, uint tile) {
    if (RAW == 0u) {
        return sums.at[tile];
    }
    uint own = 0u;
    for (uint i = rank_in_group(); i < tile; i += WORKGROUP) {
        own += sums.at[i];
    }
    uint all;
    sum_before_subgroup(subgroupAdd(own), all);
    return all;
}

// Whether a tile holds the last of `end` words; of none, the first does.
bool is_last_tile(uint tile, uint end) {
    return tile == (max(end, 1u) - 1u) / TILE;
}

#endif
