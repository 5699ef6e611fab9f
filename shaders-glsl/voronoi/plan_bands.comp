// Coloring, 2 of 8: the workgroups of all kernels that follow: none if no tile is left. Sizes of dispatches stand four words
// apart.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 left_count;
    WriteU32 groups;
    uint column_groups; // of column_ends
    uint fill_groups;   // of column_fill
    uint stack_groups;  // of row_stacks
    uint merge_groups;  // of row_merge, groups of bands
    uint row_groups;    // of row_merge, whole rows
};

void plan(uint place, uint wanted) {
    uint rows = wanted / 65535u + uint(wanted % 65535u != 0u);
    groups.at[4u * place] = rows <= 1u ? wanted : wanted / rows + uint(wanted % rows != 0u);
    groups.at[4u * place + 1u] = rows;
    groups.at[4u * place + 2u] = min(rows, 1u);
}

void main() {
    if (item_index() != 0u) {
        return;
    }
    uint tiles = left_count.at[0];
    bool any_left = tiles != 0u;
    plan(0u, any_left ? column_groups : 0u);
    plan(1u, any_left ? fill_groups : 0u);
    plan(2u, any_left ? stack_groups : 0u);
    plan(3u, any_left ? merge_groups : 0u);
    plan(4u, any_left ? row_groups : 0u);
    plan(5u, tiles); // a workgroup each in color_pixels and mark_debris
}
