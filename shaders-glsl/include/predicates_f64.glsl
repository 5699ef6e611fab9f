// The f64 part of predicates.glsl: an error bound, and cases in which f64 rounds nothing.
//
// # The bound
//
// As in `polder_predicates::filter`, whose proof assumes that a result is off by u = 2^-53 of it, and by 2^-1075 if it is
// subnormal. Vulkan promises less. Here the bound is four times as large, so that the proof holds for a device that is off
// by 4 u of each result, and by 2^-1020 where operands or results are subnormal, as when they are flushed to zero:
//
// - orient2d: `16 u ((|ax| + k) (|by| + k) + (|ay| + k) (|bx| + k))` for the differences to c and `k = 2^-150`. Two
//   differences, a product and a subtraction are off by less than `4 u * 3.1` of the absolute products; a subnormal
//   difference moves a product by no more than `2^-1020` of the other one, which `16 u k` outweighs.
// - incircle: `48 u (l_a (l_b + K) + (l_a + l_b + K) (l_c + K))` for the liftings `l` and `K = 2^-300`. The eleven
//   roundings make `4 u * 11.02` of the products of liftings; what is subnormal is outweighed by the terms with K.
//
// If something overflows, then the sum of products in the bound does too, whatever the device makes of it. So a bound whose
// exponent is not far below the largest decides nothing; the comparison is one of integers, as Vulkan promises nothing
// about NaN either.
//
// # The exact cases
//
// Let D be the largest absolute difference. If all coordinates are multiples of v and D is less than 2^m v, the differences
// are exact, being integers below 2^53 in units of v. Products of two are below 2^(2 m) v^2: for orient2d and m = 26 all of
// it is exact. Liftings and minors are below 2^(2 m + 1) v^2, so the sum of their products is below 3 * 2^(4 m + 2) v^4:
// for incircle and m = 12 all of it is exact, zeros included. So it is on lattices.
//
// Whether x is a multiple of v is asked by adding 1.5 * 2^52 units, with a unit of 2 v, and taking it away again: if
// nothing changed, x is a multiple of v. For |x| < 2^51 units the sum lies where a double is a multiple of the unit; for
// |x| < 2^52 units at least where it is one of v; beyond, any double is one of the unit. D lies between 2^-200 and 2^240, so
// that nothing underflows or overflows. This rests on correct rounding, which a device has to show in a self-test before
// f64 is used at all.
#ifndef PREDICATES_F64_GLSL
#define PREDICATES_F64_GLSL

// By their bits, so that no compiler's reading of decimal numbers matters.
#define F64_HIGH(HIGH) packDouble2x32(uvec2(0u, HIGH))
#define ORIENT2D_ERROR F64_HIGH(0x3ce00000u) /* 16 u = 2^-49 */
#define INCIRCLE_ERROR F64_HIGH(0x3cf80000u) /* 48 u = 1.5 * 2^-48 */
#define ORIENT2D_TINY F64_HIGH(0x36900000u) /* 2^-150 */
#define INCIRCLE_TINY F64_HIGH(0x2d300000u) /* 2^-300 */

// The high word of 2^1000.
const uint TOO_LARGE = 0x7e700000u;

uint high_word(double x) {
    return unpackDouble2x32(x).y & 0x7fffffffu;
}

bool multiple(double x, double shifter) {
    precise double sum = x + shifter;
    precise double rounded = sum - shifter;
    return rounded == x;
}

// 1.5 * 2^52 units, for a unit of 2^(2 - bits) times the power of two of the largest difference; 0.0 where that is out of
// range.
double shifter_of(uint largest, uint bits) {
    uint exponent = largest >> 20;
    return exponent >= 823u && exponent < 1263u ? F64_HIGH(((exponent + 54u - bits) << 20) | 0x80000u) : F64_HIGH(0u);
}

int decided(double value) {
    return int(value > F64_HIGH(0u)) - int(value < F64_HIGH(0u));
}

int filter_orient2d(uvec4 a, uvec4 b, uvec4 c) {
    double ax = packDouble2x32(a.xy), ay = packDouble2x32(a.zw);
    double bx = packDouble2x32(b.xy), by = packDouble2x32(b.zw);
    double cx = packDouble2x32(c.xy), cy = packDouble2x32(c.zw);
    precise double acx = ax - cx, acy = ay - cy;
    precise double bcx = bx - cx, bcy = by - cy;
    precise double left = acx * bcy;
    precise double right = acy * bcx;
    precise double value = left - right;
    precise double left_bound = (abs(acx) + ORIENT2D_TINY) * (abs(bcy) + ORIENT2D_TINY);
    precise double right_bound = (abs(acy) + ORIENT2D_TINY) * (abs(bcx) + ORIENT2D_TINY);
    precise double sum = left_bound + right_bound;
    precise double bound = ORIENT2D_ERROR * sum;
    if (high_word(sum) >= TOO_LARGE) {
        return UNDECIDED;
    }
    if (abs(value) > bound) {
        return decided(value);
    }
    uint largest = max(max(high_word(acx), high_word(acy)), max(high_word(bcx), high_word(bcy)));
    double shifter = shifter_of(largest, 26u);
    bool exact = shifter > F64_HIGH(0u) && multiple(ax, shifter) && multiple(ay, shifter) && multiple(bx, shifter)
        && multiple(by, shifter) && multiple(cx, shifter) && multiple(cy, shifter);
    return exact ? decided(value) : UNDECIDED;
}

int filter_incircle(uvec4 a, uvec4 b, uvec4 c, uvec4 d) {
    double ax = packDouble2x32(a.xy), ay = packDouble2x32(a.zw);
    double bx = packDouble2x32(b.xy), by = packDouble2x32(b.zw);
    double cx = packDouble2x32(c.xy), cy = packDouble2x32(c.zw);
    double dx = packDouble2x32(d.xy), dy = packDouble2x32(d.zw);
    precise double adx = ax - dx, ady = ay - dy;
    precise double bdx = bx - dx, bdy = by - dy;
    precise double cdx = cx - dx, cdy = cy - dy;
    precise double bc = bdx * cdy - cdx * bdy;
    precise double ca = cdx * ady - adx * cdy;
    precise double ab = adx * bdy - bdx * ady;
    precise double al = adx * adx + ady * ady;
    precise double bl = bdx * bdx + bdy * bdy;
    precise double cl = cdx * cdx + cdy * cdy;
    precise double value = al * bc + bl * ca + cl * ab;
    precise double blk = bl + INCIRCLE_TINY;
    precise double clk = cl + INCIRCLE_TINY;
    precise double sum = al * blk + (al + blk) * clk;
    precise double bound = INCIRCLE_ERROR * sum;
    if (high_word(sum) >= TOO_LARGE) {
        return UNDECIDED;
    }
    if (abs(value) > bound) {
        return decided(value);
    }
    uint largest = max(max(high_word(adx), high_word(ady)), max(high_word(bdx), high_word(bdy)));
    largest = max(largest, max(high_word(cdx), high_word(cdy)));
    double shifter = shifter_of(largest, 12u);
    bool exact = shifter > F64_HIGH(0u) && multiple(ax, shifter) && multiple(ay, shifter) && multiple(bx, shifter)
        && multiple(by, shifter) && multiple(cx, shifter) && multiple(cy, shifter) && multiple(dx, shifter)
        && multiple(dy, shifter);
    return exact ? decided(value) : UNDECIDED;
}

#endif
