// Exact signs in integers: no f64 operation, right on every device for all finite coordinates, whatever their magnitudes.
//
// A coordinate is the bits of an f64, low word first. Three ways, tried in this order:
//
// 1. *Fixed point*. If all coordinates of a call are multiples of a unit and below 2^61 units, they become integers below
//    2^61: differences below 2^62, liftings and minors below 2^125, the sum of three products of these below 2^252. All of
//    it stays in registers.
// 2. *Wide numbers*: mantissas of 64 bits with exponents that cannot run out, and an error bound. So points whose magnitudes
//    have nothing in common cost no more than others, as long as they are not nearly on one line or circle.
// 3. *Products of mantissas*. Otherwise the determinant is expanded in the coordinates themselves: orient2d into 6 products
//    of two, incircle into 48 products of four, each an integer below 2^212 times a power of two. They are summed from the
//    top, 256 bits at a time, until what is left cannot change the sign. So memory does not grow with the range of
//    exponents, and numbers that have nothing in common cost no more than those that nearly cancel.
#ifndef LIMBS_GLSL
#define LIMBS_GLSL

#include "buffers.glsl"

const uint64_t LOW_WORD = 0xfffffffful;

// --- Wide integers: u64vec2 has 128 bits, u64vec4 has 256, lowest first, two's complement where signed.

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

u64vec2 subtract(u64vec2 a, u64vec2 b) {
    return u64vec2(a.x - b.x, a.y - b.y - uint64_t(a.x < b.x));
}

u64vec4 add(u64vec4 a, u64vec4 b) {
    u64vec4 sum = a + b;
    uint64_t carry = uint64_t(sum.x < a.x);
    uint64_t y = sum.y + carry;
    carry = uint64_t(sum.y < a.y) | uint64_t(y < carry);
    uint64_t z = sum.z + carry;
    carry = uint64_t(sum.z < a.z) | uint64_t(z < carry);
    return u64vec4(sum.x, y, z, sum.w + carry);
}

u64vec4 multiply(u64vec2 a, u64vec2 b) {
    u64vec4 sum = u64vec4(multiply(a.x, b.x), multiply(a.y, b.y));
    sum = add(sum, u64vec4(0ul, multiply(a.y, b.x), 0ul));
    return add(sum, u64vec4(0ul, multiply(a.x, b.y), 0ul));
}

// All bits set if a is negative.
uint64_t mask_of(uint64_t a) {
    return uint64_t(int64_t(a) >> 63);
}

// A negative factor counts 2^64 too much as an unsigned one.
u64vec2 signed_product(uint64_t a, uint64_t b) {
    u64vec2 product = multiply(a, b);
    return u64vec2(product.x, product.y - (a & mask_of(b)) - (b & mask_of(a)));
}

// a is not negative.
u64vec4 signed_product(u64vec2 a, u64vec2 b) {
    u64vec4 product = multiply(a, b);
    return u64vec4(product.xy, subtract(product.zw, a & mask_of(b.y)));
}

u64vec2 cross_product(u64vec2 p, u64vec2 q) {
    return subtract(signed_product(p.x, q.y), signed_product(p.y, q.x));
}

// Of a two's complement number with these bits below the highest limb.
int sign_of(uint64_t highest, uint64_t others) {
    return int64_t(highest) < 0l ? -1 : int((highest | others) != 0ul);
}

// --- The parts of an f64

// The eleven bits of the exponent, subnormal numbers as the smallest normal ones.
int exponent_of(uvec2 bits) {
    return max(int((bits.y >> 20) & 0x7ffu), 1);
}

// The absolute value in units of 2^(exponent - 1075).
uint64_t mantissa_of(uvec2 bits) {
    uint hidden = min((bits.y >> 20) & 0x7ffu, 1u);
    return packUint2x32(uvec2(bits.x, (bits.y & 0xfffffu) | (hidden << 20)));
}

// --- 1. Fixed point

// The largest exponent of two coordinates.
int larger_exponent(uvec4 point) {
    return exponent_of(uvec2(0u, max(point.y & 0x7fffffffu, point.w & 0x7fffffffu)));
}

// A coordinate in units of 2^(exponent - 1083), below 2^61 if no exponent is larger; `lost` takes the bits below the unit.
uint64_t fixed_point(uvec2 bits, int exponent, inout uint64_t lost) {
    uint64_t value = mantissa_of(bits) << 8;
    int shift = min(exponent - exponent_of(bits), 63);
    uint64_t rounded = value >> shift;
    lost |= value ^ (rounded << shift);
    uint64_t sign = mask_of(packUint2x32(bits));
    return (rounded ^ sign) - sign;
}

u64vec2 fixed_point(uvec4 point, int exponent, inout uint64_t lost) {
    return u64vec2(fixed_point(point.xy, exponent, lost), fixed_point(point.zw, exponent, lost));
}

// --- 2. Wide numbers

// `mantissa * 2^exponent`, up to a power of two that all have in common; the highest bit of a mantissa is set, if it is not zero.
struct Wide {
    uint64_t mantissa;
    int exponent;
    bool negative;
};

uint highest_bit(uint64_t x) {
    uvec2 words = unpackUint2x32(x);
    return uint(words.y != 0u ? 32 + findMSB(words.y) : findMSB(words.x));
}

// p - q, off by 2^-60 of it at most. Bits are cut off from one of them only, and only if its exponent is so much smaller that
// the difference has 60 bits.
Wide difference(uvec2 p, uvec2 q) {
    int exponent = max(exponent_of(p), exponent_of(q));
    int64_t x = int64_t((mantissa_of(p) << 9) >> min(exponent - exponent_of(p), 63));
    int64_t y = int64_t((mantissa_of(q) << 9) >> min(exponent - exponent_of(q), 63));
    int64_t value = ((p.y >> 31) != 0u ? -x : x) - ((q.y >> 31) != 0u ? -y : y);
    uint64_t magnitude = uint64_t(value < 0l ? -value : value);
    int shift = magnitude == 0ul ? 0 : 63 - int(highest_bit(magnitude));
    return Wide(magnitude << shift, exponent - shift, value < 0l);
}

// The highest bits of the product.
Wide multiply(Wide a, Wide b) {
    return Wide(multiply(a.mantissa, b.mantissa).y, a.exponent + b.exponent, a.negative != b.negative);
}

// Adds a term to a sum in units of 2^(top + 5), below 2^59 of them.
void add_term(Wide term, inout int64_t sum, inout int top) {
    if (term.mantissa == 0ul) {
        return;
    }
    if (term.exponent > top) {
        sum >>= min(uint(term.exponent) - uint(top), 63u);
        top = term.exponent;
    }
    int64_t value = int64_t(term.mantissa >> min(uint(top) - uint(term.exponent) + 5u, 63u));
    sum += term.negative ? -value : value;
}

// What `wide_sign` does not know.
const int UNCLEAR = 2;
const int NOTHING = -0x7fffffff;

// The sign of incircle, or with three points behind an unused one of orient2d, or UNCLEAR. As `polder_predicates::wide`, from
// each point in turn as the base until one is clear: around it all bits are kept.
//
// Around the base the determinant is the sum over cyclic i, j, k of (x_i^2 + y_i^2) (x_j y_k - x_k y_j), or with i = 0 the
// second factor alone. Factors are computed anew for each term: kernels that hardly ever come here would pay for code and
// registers that keep them.
//
// A term is off by less than 2^-57 of it: 2^-60 by each of four differences, 2^-62, 2^-61 and 2^-60 by the products. That is
// less than 4 units of the sum, and it may lose two more units where it is added. So with 12 terms a sum 72 units away from
// zero has the right sign. A difference is zero only if it is exactly zero, so without any term the determinant is.
int wide_sign(uvec4 points[4], bool incircle) {
    [[dont_unroll]] for (uint base = 0u; base < 4u; base++) {
        int64_t sum = 0l;
        int top = NOTHING;
        uvec4 from = points[3];
        [[dont_unroll]] for (uint term = 0u; term < (incircle ? 12u : 2u); term++) {
            bool right = (term & 1u) != 0u;
            uint lifting_axis = (term >> 1) & 1u, i = term >> 2;
            uint j = (i + (right ? 2u : 1u)) % 3u, k = (i + (right ? 1u : 2u)) % 3u;
            Wide value;
            [[dont_unroll]] for (uint factor = 0u; factor < (incircle ? 4u : 2u); factor++) {
                uvec4 point = points[factor == 0u ? j : (factor == 1u ? k : i)];
                bool second = factor == 1u || (factor > 1u && lifting_axis != 0u);
                Wide next = difference(second ? point.zw : point.xy, second ? from.zw : from.xy);
                value = factor == 0u ? next : multiply(value, next);
            }
            value.negative = value.negative != right;
            add_term(value, sum, top);
        }
        if (top == NOTHING) {
            return 0;
        }
        if (sum >= 72l || sum <= -72l) {
            // Each step around four points is an odd permutation.
            return (sum < 0l) != (incircle && (base & 1u) != 0u) ? -1 : 1;
        }
        uvec4 first = points[incircle ? 0 : 1];
        points[0] = points[1];
        points[1] = points[2];
        points[2] = points[3];
        points[3] = first;
    }
    return UNCLEAR;
}

// --- 3. Products of mantissas

// Bit i + 4 j + 16 k: whether the permutation (i, j, k, l) is odd.
const uint64_t ODD_PERMUTATIONS = 0x214108241082840ul;
// No product has more bits.
const int PRODUCT_BITS = 212;
// The bits that are summed at a time, in a u64vec4.
const int WINDOW_BITS = 256;

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
    // For orient2d, in the place of the lifting. Exponents are all too large by the same number of biases.
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
    int exponent = max(larger_exponent(a), max(larger_exponent(b), larger_exponent(c)));
    uint64_t lost = 0ul;
    u64vec2 origin_c = fixed_point(c, exponent, lost);
    u64vec2 p = fixed_point(a, exponent, lost) - origin_c;
    u64vec2 q = fixed_point(b, exponent, lost) - origin_c;
    if (lost != 0ul) {
        int sign = wide_sign(uvec4[](c, a, b, c), false);
        return sign != UNCLEAR ? sign : product_sum_sign(uvec4[](a, b, c, uvec4(0u)), false);
    }
    u64vec2 value = cross_product(p, q);
    return sign_of(value.y, value.x);
}

int exact_incircle(uvec4 a, uvec4 b, uvec4 c, uvec4 d) {
    int exponent = max(max(larger_exponent(a), larger_exponent(b)), max(larger_exponent(c), larger_exponent(d)));
    uint64_t lost = 0ul;
    u64vec2 origin_d = fixed_point(d, exponent, lost);
    u64vec2 p = fixed_point(a, exponent, lost) - origin_d;
    u64vec2 q = fixed_point(b, exponent, lost) - origin_d;
    u64vec2 r = fixed_point(c, exponent, lost) - origin_d;
    if (lost != 0ul) {
        int sign = wide_sign(uvec4[](a, b, c, d), true);
        return sign != UNCLEAR ? sign : product_sum_sign(uvec4[](a, b, c, d), true);
    }
    u64vec4 sum = u64vec4(0ul);
    // Not unrolled: a third of the code.
    [[dont_unroll]] for (int k = 0; k < 3; k++) {
        u64vec2 lifting = add(signed_product(p.x, p.x), signed_product(p.y, p.y));
        sum = add(sum, signed_product(lifting, cross_product(q, r)));
        u64vec2 first = p;
        p = q;
        q = r;
        r = first;
    }
    return sign_of(sum.w, sum.x | sum.y | sum.z);
}

#endif
