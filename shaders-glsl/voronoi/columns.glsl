// The row of the nearest site in a pixel's column: half words, those of two columns in a word, a row of whole words for each
// row of pixels.
#ifndef COLUMNS_GLSL
#define COLUMNS_GLSL

#include "tiles.glsl"

const uint NO_ROW = 0xffffu;

uint pairs_of(uint width) {
    return (width + 1u) / 2u;
}

uint nearest_row(ReadU32 nearest, uint x, uint y, uint width) {
    return nearest.at[y * pairs_of(width) + x / 2u] >> 16u * (x & 1u) & 0xffffu;
}

#endif
