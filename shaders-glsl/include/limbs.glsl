// Exact signs in integers: no f64 operation, right on every device for all finite coordinates, whatever their magnitudes.
//
// A coordinate is the bits of an f64, low word first. Two ways, tried in this order:
//
// 1. *Fixed point*. If all coordinates of a call are multiples of 2^low and below 2^(low + 61), they become integers below
//    2^61: differences below 2^62, liftings and minors below 2^125, the sum of three products of these below 2^252. All of
//    it stays in registers.
// 2. *Products of mantissas*. Otherwise the determinant is expanded in the coordinates themselves: orient2d into 6 products
//    of two, incircle into 48 products of four, each an integer below 2^212 times a power of two. They are summed from the
//    top, 256 bits at a time, until what is left cannot change the sign. So memory does not grow with the range of
//    exponents, and numbers that have nothing in common cost no more than those that nearly cancel.
#ifndef LIMBS_GLSL
#define LIMBS_GLSL

#include "buffers.glsl"

const uint64_t LOW_WORD = 0xfffffffful;

// --- Wide integers: u64vec2 has 128 bits, u64vec4 has 256, low word first, two's complement where signed.

u64vec2 multiply(uint64_t a, uint64_t b) {
    uint64_t a0 = a & LOW_WORD, a1 = a >> 32, b0 = b & LOW_WORD, b1 = b >> 32;
    uint64_t low = a0 * b0, left = a1 * b0, right = a0 * b1;
    uint64_t middle = (low >> 32) + (left & LOW_WORD) + (right & LOW_WORD);
    uint64_t high = a1 * b1 + (left >> 32) + (right >> 32) + (middle >> 32);
    return u64vec2((middle << 32) | (low & LOW_WORD), high);
}

u64vec2 add(u64vec2 a, u64vec2 b) {
    uint64_t low = a.x + b.x;
    return u64vec2(low, a.y + b.y + uint64_t(low < a.x));
}

u64vec2 negated(u64vec2 a) {
    return u64vec2(~a.x + 1ul, ~a.y + uint64_t(a.x == 0ul));
}

u64vec4 add(u64vec4 a, u64vec4 b) {
    uint64_t carry;
    u64vec4 sum;
    sum.x = a.x + b.x;
    carry = uint64_t(sum.x < a.x);
    sum.y = a.y + b.y;
    uint64_t first = uint64_t(sum.y < a.y);
    sum.y += carry;
    carry = first | uint64_t(sum.y < carry);
    sum.z = a.z + b.z;
    first = uint64_t(sum.z < a.z);
    sum.z += carry;
    carry = first | uint64_t(sum.z < carry);
    sum.w = a.w + b.w + carry;
    return sum;
}

u64vec4 negated(u64vec4 a) {
    return add(u64vec4(~a.x, ~a.y, ~a.z, ~a.w), u64vec4(1ul, 0ul, 0ul, 0ul));
}

u64vec4 multiply(u64vec2 a, u64vec2 b) {
    u64vec2 low = multiply(a.x, b.x), high = multiply(a.y, b.y);
    u64vec2 left = multiply(a.y, b.x), right = multiply(a.x, b.y);
    u64vec4 sum = u64vec4(low, high);
    sum = add(sum, u64vec4(0ul, left, 0ul));
    return add(sum, u64vec4(0ul, right, 0ul));
}

u64vec2 signed_product(int64_t a, int64_t b) {
    u64vec2 magnitude = multiply(uint64_t(abs(a)), uint64_t(abs(b)));
    return (a < 0l) != (b < 0l) ? negated(magnitude) : magnitude;
}

int sign_of(u64vec2 a) {
    return int64_t(a.y) < 0l ? -1 : int((a.x | a.y) != 0ul);
}

int sign_of(u64vec4 a) {
    return int64_t(a.w) < 0l ? -1 : int((a.x | a.y | a.z | a.w) != 0ul);
}

// --- The parts of an f64

// The integer and the power of two that it is to be multiplied with; without the sign.
uint64_t mantissa_of(uvec2 bits) {
    uint high = bits.y & 0xfffffu;
    return packUint2x32(uvec2(bits.x, (bits.y & 0x7ff00000u) == 0u ? high : high | 0x100000u));
}

int exponent_of(uvec2 bits) {
    return max(int((bits.y >> 20) & 0x7ffu), 1) - 1075;
}

// Exponents of the lowest bit that is set in any coordinate, and of the one after the highest.
void widen(uvec2 bits, inout ivec2 span) {
    uvec2 mantissa = unpackUint2x32(mantissa_of(bits));
    if ((mantissa.x | mantissa.y) != 0u) {
        int lowest = mantissa.x != 0u ? findLSB(mantissa.x) : 32 + findLSB(mantissa.y);
        int highest = mantissa.y != 0u ? 33 + findMSB(mantissa.y) : 1 + findMSB(mantissa.x);
        int exponent = exponent_of(bits);
        span = ivec2(min(span.x, exponent + lowest), max(span.y, exponent + highest));
    }
}

void widen(uvec4 point, inout ivec2 span) {
    widen(point.xy, span);
    widen(point.zw, span);
}

// In units of 2^low, which it is a multiple of.
int64_t fixed_point(uvec2 bits, int low) {
    uint64_t mantissa = mantissa_of(bits);
    int shift = clamp(exponent_of(bits) - low, -63, 63);
    mantissa = shift < 0 ? mantissa >> uint(-shift) : mantissa << uint(shift);
    return (bits.y & 0x80000000u) != 0u ? -int64_t(mantissa) : int64_t(mantissa);
}

// --- 1. Fixed point

const ivec2 NO_SPAN = ivec2(0x7fff, -0x7fff);
const int FIXED_POINT_BITS = 61;

int fixed_orient2d(uvec4 a, uvec4 b, uvec4 c, int low) {
    int64_t cx = fixed_point(c.xy, low), cy = fixed_point(c.zw, low);
    int64_t ax = fixed_point(a.xy, low) - cx, ay = fixed_point(a.zw, low) - cy;
    int64_t bx = fixed_point(b.xy, low) - cx, by = fixed_point(b.zw, low) - cy;
    return sign_of(add(signed_product(ax, by), negated(signed_product(ay, bx))));
}

int fixed_incircle(uvec4 a, uvec4 b, uvec4 c, uvec4 d, int low) {
    int64_t dx = fixed_point(d.xy, low), dy = fixed_point(d.zw, low);
    int64_t ax = fixed_point(a.xy, low) - dx, ay = fixed_point(a.zw, low) - dy;
    int64_t bx = fixed_point(b.xy, low) - dx, by = fixed_point(b.zw, low) - dy;
    int64_t cx = fixed_point(c.xy, low) - dx, cy = fixed_point(c.zw, low) - dy;
    u64vec4 sum = u64vec4(0ul);
    // Not unrolled: a third of the code.
    [[dont_unroll]] for (int k = 0; k < 3; k++) {
        uint64_t x = uint64_t(abs(ax)), y = uint64_t(abs(ay));
        u64vec2 lifting = add(multiply(x, x), multiply(y, y));
        u64vec2 minor = add(signed_product(bx, cy), negated(signed_product(by, cx)));
        bool negative = int64_t(minor.y) < 0l;
        u64vec4 term = multiply(lifting, negative ? negated(minor) : minor);
        sum = add(sum, negative ? negated(term) : term);
        int64_t x0 = ax, y0 = ay;
        ax = bx;
        ay = by;
        bx = cx;
        by = cy;
        cx = x0;
        cy = y0;
    }
    return sign_of(sum);
}

// --- 2. Products of mantissas

// Bit i + 4 j + 16 k: whether the permutation (i, j, k, l) is odd.
const uint64_t ODD_PERMUTATIONS = 0x214108241082840ul;
// No product has more bits.
const int PRODUCT_BITS = 212;
// The bits that are summed at a time, in a u64vec4.
const int WINDOW_BITS = 256;
const int NOTHING = -0x7fffffff;

// By less than 256 bits to the left or, if negative, to the right; what leaves the 256 bits is lost.
u64vec4 shifted(u64vec4 a, int by) {
    if (by < 0) {
        uint bits = uint(-by);
        if (bits >= 128u) {
            a = u64vec4(a.z, a.w, 0ul, 0ul);
        }
        if ((bits & 64u) != 0u) {
            a = u64vec4(a.y, a.z, a.w, 0ul);
        }
        bits &= 63u;
        u64vec4 higher = u64vec4(a.y, a.z, a.w, 0ul);
        return (a >> bits) | ((higher << 1u) << (63u - bits));
    }
    uint bits = uint(by);
    if (bits >= 128u) {
        a = u64vec4(0ul, 0ul, a.x, a.y);
    }
    if ((bits & 64u) != 0u) {
        a = u64vec4(0ul, a.x, a.y, a.z);
    }
    bits &= 63u;
    u64vec4 lower = u64vec4(0ul, a.x, a.y, a.z);
    return (a << bits) | ((lower >> 1u) >> (63u - bits));
}

// Sums up what lies in the window; `high` takes what leaves it.
void accumulate(u64vec4 addend, bool negative, inout u64vec4 low, inout int high) {
    uint64_t carry = uint64_t(negative);
    for (int k = 0; k < 4; k++) {
        uint64_t limb = negative ? ~addend[k] : addend[k];
        uint64_t sum = low[k] + limb;
        uint64_t first = uint64_t(sum < limb);
        sum += carry;
        carry = first | uint64_t(sum < carry);
        low[k] = sum;
    }
    high += int(carry) - int(negative);
}

// The products are numbered by four numbers of two bits: i, j, k and, for the lifting, the axis. incircle is the
// determinant of the rows (x, y, x^2 + y^2, 1), the sum over the permutations (i, j, k, l) of the four points of their sign
// times x_i y_j (x_k^2 + y_k^2). orient2d is that of the rows (x, y, 1), the sum of x_i y_j and -x_i y_j.
//
// 1. Each product is added to a window of 256 bits, whose upper end lies above all of them: the bits inside, cut off
//    below.
// 2. Less than one unit of the window was cut off from each of the at most 48. So if the sum is 64 units or more away
//    from zero, or nothing was cut off, its sign is the sign of the determinant; or if it is not zero, and all that was
//    cut off lies 6 bits below.
// 3. Otherwise the sum is carried over into a window right below or, if it is zero, below all bits that are zero.
//
// Each window ends with the last bit of a product at least, since a product is shorter than a window: 49 windows suffice.
int product_sum_sign(uvec4 points[4], bool incircle) {
    uint64_t mantissas[9];
    int exponents[9];
    uint negatives = 0u;
    for (int p = 0; p < 4; p++) {
        uvec4 point = points[p];
        mantissas[2 * p] = mantissa_of(point.xy);
        mantissas[2 * p + 1] = mantissa_of(point.zw);
        exponents[2 * p] = exponent_of(point.xy);
        exponents[2 * p + 1] = exponent_of(point.zw);
        negatives |= ((point.y >> 31) | ((point.w >> 31) << 1)) << uint(2 * p);
    }
    // For orient2d, in the place of the lifting.
    mantissas[8] = 1ul;
    exponents[8] = 0;
    uint end = incircle ? 128u : 16u, count = incircle ? 4u : 3u;
    int top = NOTHING, rest = NOTHING, high = 0;
    u64vec4 low = u64vec4(0ul);
    [[dont_unroll]] for (uint window = 0u; window <= 49u; window++) {
        bool first = window == 0u;
        int bottom = first ? NOTHING : top - WINDOW_BITS;
        rest = NOTHING;
        [[dont_unroll]] for (uint product = 0u; product < end; product++) {
            uint i = product & 3u, j = (product >> 2) & 3u, k = (product >> 4) & 3u, axis = product >> 6;
            if (i == j || i >= count || j >= count || (incircle && (i == k || j == k))) {
                continue;
            }
            uint x = 2u * i, y = 2u * j + 1u, lifting = incircle ? 2u * k + axis : 8u;
            uint64_t mx = mantissas[x], my = mantissas[y], ml = mantissas[lifting];
            if (mx == 0ul || my == 0ul || ml == 0ul) {
                continue;
            }
            int exponent = exponents[x] + exponents[y] + 2 * exponents[lifting];
            if (first) {
                top = max(top, exponent + PRODUCT_BITS);
                continue;
            }
            if (exponent < bottom) {
                rest = max(rest, min(exponent + PRODUCT_BITS, bottom));
            }
            if (exponent >= top || exponent + PRODUCT_BITS <= bottom) {
                continue;
            }
            bool odd = incircle ? ((ODD_PERMUTATIONS >> (product & 63u)) & 1ul) != 0ul : (i + 2u) % 3u == j;
            bool negative = odd != ((((negatives >> x) ^ (negatives >> y)) & 1u) != 0u);
            u64vec4 value = multiply(multiply(mx, my), multiply(ml, ml));
            accumulate(shifted(value, exponent - bottom), negative, low, high);
        }
        if (first) {
            if (top == NOTHING) {
                return 0;
            }
            continue;
        }
        int sign = high < 0 ? -1 : int(high > 0 || (low.x | low.y | low.z | low.w) != 0ul);
        bool positive_small = high == 0 && (low.y | low.z | low.w) == 0ul && low.x < 64ul;
        bool negative_small = high == -1 && (~low.y | ~low.z | ~low.w) == 0ul && ~low.x < 64ul;
        if (!(positive_small || negative_small) || rest == NOTHING || (sign != 0 && rest + 6 <= bottom)) {
            return sign;
        }
        top = sign == 0 ? rest : bottom;
        high = int(low.x);
        low = u64vec4(0ul);
    }
    return 0;
}

// --- Signs

int exact_orient2d(uvec4 a, uvec4 b, uvec4 c) {
    ivec2 span = NO_SPAN;
    widen(a, span);
    widen(b, span);
    widen(c, span);
    if (span.y - span.x <= FIXED_POINT_BITS) {
        return fixed_orient2d(a, b, c, span.x);
    }
    return product_sum_sign(uvec4[](a, b, c, uvec4(0u)), false);
}

int exact_incircle(uvec4 a, uvec4 b, uvec4 c, uvec4 d) {
    ivec2 span = NO_SPAN;
    widen(a, span);
    widen(b, span);
    widen(c, span);
    widen(d, span);
    if (span.y - span.x <= FIXED_POINT_BITS) {
        return fixed_incircle(a, b, c, d, span.x);
    }
    return product_sum_sign(uvec4[](a, b, c, d), true);
}

#endif
