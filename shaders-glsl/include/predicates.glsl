// The predicates of polder-predicates on the device: orientation, and whether an edge must be flipped.
//
// How a kernel uses it:
//
// - `ReadPoints positions;` among its arguments (`View<[u32; 4]>` in Rust: the bits of a `DVec2`), and
//   `Point p = point_at(positions, v);`. A `Point` is bits: compare it by `same_point` and `compare_points` alone.
// - Specialization constant 1 is `ARITHMETIC` and is declared here; a kernel's own constants are numbered from 2.
//   EXACT: f64 with a proven error bound, and f64 where it is exact; then integers of any size for the rest. INTEGERS: no
//   f64 is executed at all. Both know every sign, for all finite coordinates, and never return UNDECIDED. This is how
//   kernels are made for users, so they need not ask for UNDECIDED.
// - FAST is EXACT without its integers: half the time to compile, fewer registers, and UNDECIDED for what the filter leaves.
//   A kernel may put such items on a list that a second kernel works off, as `takeout_cut` does. Others would lose by it:
//   integers behind the filter cost a tenth of a test where they are not needed, a second dispatch costs more, and the list
//   costs once more where they are.
// - Every call is inlined, and the integers are long: call from few places, in a loop rather than one after the other.
// - A kernel that includes this file is compiled a second time with NO_FLOAT64 defined, without the capability Float64:
//   ARITHMETIC is INTEGERS there whatever the constant says. On the host `Arithmetic::kernel` takes the right one.
#ifndef PREDICATES_GLSL
#define PREDICATES_GLSL

#include "buffers.glsl"
#include "limbs.glsl"

#define Point uvec4

BUFFER(ReadPoints, uvec4, 16, readonly);

// What ARITHMETIC may be.
const uint FAST = 0u;
const uint EXACT = 1u;
const uint INTEGERS = 2u;
layout(constant_id = 1) const uint ARITHMETIC = EXACT;

// Next to the signs -1, 0 and 1, and the answers 0 and 1.
const int UNDECIDED = 2;

Point point_at(ReadPoints positions, uint v) {
    return positions.at[v];
}

// Ascending with the number, -0.0 like 0.0: sign and magnitude as two's complement.
int64_t order_of(uvec2 bits) {
    uint64_t word = packUint2x32(bits);
    uint64_t sign = mask_of(word);
    return int64_t(((word & 0x7ffffffffffffffful) ^ sign) - sign);
}

bool is_less(i64vec2 a, i64vec2 b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

i64vec2 order_of(Point p) {
    return i64vec2(order_of(p.xy), order_of(p.zw));
}

// -1, 0 or 1: by x, then by y.
int compare_points(Point a, Point b) {
    i64vec2 p = order_of(a), q = order_of(b);
    return int(is_less(q, p)) - int(is_less(p, q));
}

bool same_point(Point a, Point b) {
    return compare_points(a, b) == 0;
}

#ifndef NO_FLOAT64
#include "predicates_f64.glsl"
#endif

// The sign of the exact orientation of abc: 1 if it is counterclockwise; or UNDECIDED.
int orient2d(Point a, Point b, Point c) {
#ifndef NO_FLOAT64
    if (ARITHMETIC != INTEGERS) {
        int sign = filter_orient2d(a, b, c);
        if (ARITHMETIC == FAST || sign != UNDECIDED) {
            return sign;
        }
    }
#endif
    return exact_orient2d(a, b, c);
}

// The sign of the exact in-circle determinant: for abc counterclockwise, 1 if d lies inside the circle; or UNDECIDED.
int incircle(Point a, Point b, Point c, Point d) {
#ifndef NO_FLOAT64
    if (ARITHMETIC != INTEGERS) {
        int sign = filter_incircle(a, b, c, d);
        if (ARITHMETIC == FAST || sign != UNDECIDED) {
            return sign;
        }
    }
#endif
    return exact_incircle(a, b, c, d);
}

// Whether the edge bc of the counterclockwise triangles abc and dcb must be flipped to ad: 1 or 0, or UNDECIDED. Of
// cocircular points, the smallest keeps its diagonal.
int must_flip(Point a, Point b, Point c, Point d) {
    int sign = incircle(a, b, c, d);
    if (sign != 0) {
        return sign < 0 ? 0 : sign;
    }
    // The smaller of a and d against the smaller of b and c.
    i64vec2 orders[4] = i64vec2[](order_of(a), order_of(d), order_of(b), order_of(c));
    bool flip = is_less(orders[0], orders[2]) && is_less(orders[0], orders[3]);
    return int(flip || (is_less(orders[1], orders[2]) && is_less(orders[1], orders[3])));
}

#endif
