// Tiles of the grid: 64 columns, which are two words of bits, and 62 rows, which are 64 with one around them.
#ifndef TILES_GLSL
#define TILES_GLSL

#include "ranks.glsl"

const uint TILE_WIDTH = 64u;
const uint TILE_HEIGHT = 62u;

uint tiles_across(uint width) {
    return (width + TILE_WIDTH - 1u) / TILE_WIDTH;
}

// Whether a tile that is left to the bands lies in any of these rows.
bool wanted_rows(ReadU32 wanted, uint from, uint to) {
    for (uint row = from / TILE_HEIGHT; row * TILE_HEIGHT < to; row++) {
        if (wanted.at[row] != 0u) {
            return true;
        }
    }
    return false;
}

#endif
