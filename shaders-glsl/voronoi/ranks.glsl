// A grid of bits, a row of whole words for each row of pixels, and for each word how many bits stand before it.
#ifndef RANKS_GLSL
#define RANKS_GLSL

#include "grid.glsl"

// How many bits stand before that of a pixel.
uint number_of(ReadU32 bits, ReadU32 ranks, uint pixel, uint pitch) {
    uint word = word_of(pixel, pitch);
    return ranks.at[word] + uint(bitCount(bits.at[word] & below(pixel)));
}

#endif
