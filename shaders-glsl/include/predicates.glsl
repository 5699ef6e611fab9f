// The predicates of polder-predicates on the device: orientation, and whether an edge must be flipped.
//
// How a kernel uses it:
//
// - `ReadPoints positions;` among its arguments (`View<[u32; 4]>` in Rust: the bits of a `DVec2`), and
//   `Point p = point_at(positions, v);`. A `Point` is bits: compare it by `same_point` and `compare_points` alone.
// - Specialization constant 1 is `ARITHMETIC` and is declared here; a kernel's own constants are numbered from 2.
//   FAST: f64 with a proven error bound, and f64 where it is exact; little code and few registers; what it does not know it
//   says is UNDECIDED. EXACT: the same, then integers of any size for the rest. INTEGERS: no f64 is executed at all.
//   EXACT and INTEGERS know every sign, for all finite coordinates. They never return UNDECIDED.
// - An item of which a predicate is UNDECIDED writes nothing, but appends itself to a list. The same kernel compiled as
//   EXACT then runs over that list.
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
layout(constant_id = 1) const uint ARITHMETIC = FAST;

// Next to the signs -1, 0 and 1, and the answers 0 and 1.
const int UNDECIDED = 2;

Point point_at(ReadPoints positions, uint v) {
    return positions.at[v];
}

// Ascending with the number, -0.0 like 0.0.
uint64_t order_of(uvec2 bits) {
    uint64_t word = packUint2x32(bits);
    if ((word << 1u) == 0ul) {
        word = 0ul;
    }
    return (bits.y & 0x80000000u) != 0u && word != 0ul ? ~word : word | 0x8000000000000000ul;
}

// -1, 0 or 1: by x, then by y.
int compare_points(Point a, Point b) {
    uint64_t ax = order_of(a.xy), bx = order_of(b.xy);
    uint64_t ay = order_of(a.zw), by = order_of(b.zw);
    bool less = ax < bx || (ax == bx && ay < by);
    return less ? -1 : int(ax != bx || ay != by);
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
    Point outer = compare_points(a, d) < 0 ? a : d;
    Point inner = compare_points(b, c) < 0 ? b : c;
    return int(compare_points(outer, inner) < 0);
}

#endif
