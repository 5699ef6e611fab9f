// Corners of the grid, where four pixels meet, `width + 1` by `height + 1` of them, and the colors around one.
//
// Corners are kept in words of 32 of a row, the first at column 0; a row has `words_in_row` of them. Side s of a corner is
// south, east, north, west; it lies between the pixels s and s + 1, which are numbered counterclockwise from the south-west.
#ifndef CORNERS_GLSL
#define CORNERS_GLSL

#include "buffers.glsl"
#include "mesh.glsl"

uint words_in_row(uint width) {
    return width / 32u + 1u;
}

// Coordinates to the left of the grid and below wrap round to numbers beyond it.
uint color_of(ReadU32 colors, uint x, uint y, uint width, uint height) {
    return x < width && y < height ? colors.at[y * width + x] : GHOST;
}

#endif
