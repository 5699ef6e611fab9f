// A coarse grid over the vertices, with up to two of them for each cell. It helps to find the mesh under a point; what is
// found may not depend on which vertices they are.
//
// Places are integers, 64 of them to the side of a cell, counted from the lower left corner of the grid.
#ifndef CELLS_GLSL
#define CELLS_GLSL

#include "predicates.glsl"
#include "units.glsl"

i64vec2 place_of(Point p, int exponent, int64_t low_x, int64_t low_y) {
    return i64vec2(floor_units(packUint2x32(p.xy), exponent) - low_x, floor_units(packUint2x32(p.zw), exponent) - low_y);
}

// The cell of a place; the one at the border for a place outside.
uvec2 cell_of(i64vec2 place, uint width, uint height) {
    return uvec2(clamp(place >> 6, i64vec2(0), i64vec2(width, height) - 1));
}

#endif
