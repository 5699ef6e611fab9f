// How well a point suits its container: `reference::key` word for word. Integer arithmetic alone.
#ifndef INSERT_KEY_GLSL
#define INSERT_KEY_GLSL

#include "predicates.glsl"

const uint INSIDE = 0x80000000u;
const int PLACES = 58;

// An exponent with |x| < 2 to its power.
int top_of(uvec2 x) {
    return max(int(x.y >> 20 & 0x7ffu), 1) - 1022;
}

int top_of(Point p) {
    return max(top_of(p.xy), top_of(p.zw));
}

// x times 2 to the power of PLACES - top, cut off to an integer below 2^58 in magnitude.
int64_t fixed_of(uvec2 x, int top) {
    uint exponent = x.y >> 20 & 0x7ffu;
    uint64_t mantissa = packUint2x32(uvec2(x.x, x.y & 0xfffffu | uint(exponent != 0u) << 20));
    int shift = max(int(exponent), 1) - 1075 + PLACES - top;
    uint64_t magnitude = shift >= 0 ? mantissa << shift : mantissa >> min(-shift, 63);
    return (x.y & 0x80000000u) != 0u ? -int64_t(magnitude) : int64_t(magnitude);
}

uint64_t magnitude_of(int64_t x) {
    return uint64_t(x < 0l ? -x : x);
}

// A number of two words as its exponent, counted from one below -base, and so many bits of its fraction; zero for zero.
uint float_of(uint64_t high, uint64_t low, int base, uint fraction_bits) {
    if (high == 0ul && low == 0ul) {
        return 0u;
    }
    uint place = high != 0ul ? 64u + highest_bit(high) : highest_bit(low);
    // The leading bit moved to the top of the high word, and what follows it.
    uint64_t leading = high;
    if (place < 64u) {
        leading = low << (63u - place);
    } else if (place < 127u) {
        leading = high << (127u - place) | low >> (place - 63u);
    }
    uint fraction = uint((leading << 1u) >> (64u - fraction_bits));
    return uint(base + int(place) + 1) << fraction_bits | fraction;
}

// Twice the distance along one axis from the middle of u and w.
uint64_t along(uvec2 p, uvec2 u, uvec2 w, int top) {
    return magnitude_of(2l * fixed_of(p, top) - fixed_of(u, top) - fixed_of(w, top));
}

uint score_on_edge(Point p, Point u, Point w) {
    int top = max(max(top_of(p), top_of(u)), top_of(w));
    uint64_t sum = along(p.xy, u.xy, w.xy, top) + along(p.zw, u.zw, w.zw, top);
    return float_of(0ul, sum, top + 1200, 19u);
}

// The product of two signed numbers, in two words.
void product(int64_t a, int64_t b, out uint64_t high, out uint64_t low) {
    uint64_t x = magnitude_of(a), y = magnitude_of(b);
    uint64_t x0 = x & 0xfffffffful, x1 = x >> 32u, y0 = y & 0xfffffffful, y1 = y >> 32u;
    // Below 2^59 each, so that nothing carries out of the middle.
    uint64_t middle = x0 * y1 + x1 * y0 + (x0 * y0 >> 32u);
    low = middle << 32u | (x0 * y0 & 0xfffffffful);
    high = x1 * y1 + (middle >> 32u);
    if ((a < 0l) != (b < 0l)) {
        low = ~low + 1ul;
        high = ~high + uint64_t(low == 0ul);
    }
}

uint score_outside(Point p, Point u, Point w) {
    int top = max(max(top_of(p), top_of(u)), top_of(w));
    int64_t ux = fixed_of(u.xy, top), uy = fixed_of(u.zw, top);
    int64_t px = fixed_of(p.xy, top) - ux, py = fixed_of(p.zw, top) - uy;
    int64_t wx = fixed_of(w.xy, top) - ux, wy = fixed_of(w.zw, top) - uy;
    uint64_t high, low, less_high, less_low;
    product(wy, px, high, low);
    product(wx, py, less_high, less_low);
    // Positive where the point lies right of the edge.
    high -= less_high + uint64_t(low < less_low);
    low -= less_low;
    bool negative = high >> 63u != 0ul;
    return 0xffffffffu - (negative ? 0u : float_of(high, low, 2 * top + 2400, 18u));
}

#endif
