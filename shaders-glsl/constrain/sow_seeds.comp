// Puts up to two vertices that lie in a cell of the grid into it: some with an even priority, and some with an odd one, so that
// they come from anywhere in the cell. Of all that lie there any may be the last to come.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "mesh.glsl"
#include "cells.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32 spokes;
    WriteU32 seeds; // two for each cell; all NONE before
    int64_t low_x;
    int64_t low_y;
    int exponent;
    uint width;
    uint height;
    uint vertices;
};

void main() {
    uint v = item_index();
    if (v < vertices && spokes.at[v] != NONE) {
        uvec2 cell = cell_of(place_of(point_at(positions, v), exponent, low_x, low_y), width, height);
        seeds.at[2u * (cell.y * width + cell.x) + (priority(v) & 1u)] = v;
    }
}
