// Centers of pixels, in integers: the bits of `GridMapping::center`.
#ifndef CENTER_GLSL
#define CENTER_GLSL

#include "buffers.glsl"

// The bits of units * 2^exponent, which is a double: units have up to 54 bits, the last of them zero if they are so many,
// and the exponent is at least -1074.
uvec2 double_bits(int64_t units, int exponent) {
    uint64_t magnitude = uint64_t(units < 0 ? -units : units);
    uvec2 halves = unpackUint2x32(magnitude);
    if (magnitude == 0ul) {
        return uvec2(0u);
    }
    int top = halves.y != 0u ? 32 + findMSB(halves.y) : findMSB(halves.x);
    uint64_t bits;
    if (top + exponent >= -1022) {
        uint64_t significand = top <= 52 ? magnitude << (52 - top) : magnitude >> (top - 52);
        bits = significand & 0xffffffffffffful | uint64_t(top + exponent + 1023) << 52;
    } else {
        bits = magnitude << (exponent + 1074);
    }
    return unpackUint2x32(bits) | uvec2(0u, units < 0 ? 0x80000000u : 0u);
}

// A grid of pixels, from its lower left corner: units of each axis, and half the sides of a pixel in them.
struct Grid {
    i64vec2 translation;
    ivec2 exponents;
    uvec2 half_sides;
};

// `pixel` is y << 16 | x.
uvec4 center_of(uint pixel, Grid grid) {
    uvec2 odd = 2u * uvec2(pixel & 0xffffu, pixel >> 16) + 1u;
    int64_t x = grid.translation.x + int64_t(uint64_t(odd.x) * grid.half_sides.x);
    int64_t y = grid.translation.y + int64_t(uint64_t(odd.y) * grid.half_sides.y);
    return uvec4(double_bits(x, grid.exponents.x), double_bits(y, grid.exponents.y));
}

#endif
