// The grid: pixels in memory hold x in the lower half of a word and y in the upper; and the one total order that settles
// every tie of this stage.
#ifndef GRID_GLSL
#define GRID_GLSL

#include "count.glsl"
#include "invocations.glsl"

const uint NONE = 0xffffffffu;
const uint UNCOLORED = NONE;

uint index_of(uint pixel, uint width) {
    return (pixel >> 16) * width + (pixel & 0xffffu);
}

// Words in a row of a grid of bits, 32 pixels a word.
uint pitch_of(uint width) {
    return (width + 31u) / 32u;
}

uint word_of(uint pixel, uint pitch) {
    return (pixel >> 16) * pitch + ((pixel & 0xffffu) >> 5);
}

// The bits before a place in its word.
uint below(uint place) {
    return (1u << (place & 31u)) - 1u;
}

uint pixel_at(uint index, uint width) {
    return (index / width) << 16 | index % width;
}

// Squared distance, packed site, packed pixel: x before y.
uvec3 key_of(uint pixel, uint site) {
    int x = int(pixel & 0xffffu) - int(site & 0xffffu);
    int y = int(pixel >> 16) - int(site >> 16);
    return uvec3(uint(x * x + y * y), site << 16 | site >> 16, pixel << 16 | pixel >> 16);
}

bool before(uvec3 a, uvec3 b) {
    return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z < b.z)));
}

// The pixels around one, k from 0 to 7, row by row; NONE outside the grid.
uint neighbor(uint pixel, uint k, uint width, uint height) {
    uint place = k < 4u ? k : k + 1u;
    uint x = (pixel & 0xffffu) + place % 3u - 1u;
    uint y = (pixel >> 16) + place / 3u - 1u;
    return x < width && y < height ? y << 16 | x : NONE;
}

#endif
