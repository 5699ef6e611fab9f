// Step 1 of a round: whether an edge must be flipped.
#ifndef VERDICT_GLSL
#define VERDICT_GLSL

#include "predicates.glsl"
#include "rounds.glsl"

const uint LEGAL = 0u;
const uint ILLEGAL = 1u;
const uint OPEN = 2u;

// Of an edge from b to c that is not constrained, between the corners a, on its left, and d: `is_illegal` of the reference.
uint verdict(ReadPoints positions, uint a, uint b, uint c, uint d) {
    if (a == d || a == GHOST || d == GHOST) {
        return LEGAL;
    }
    int sign;
    if (b == GHOST || c == GHOST) {
        // From v to the ghost, or back, in the ghost triangle of the hull edge from v to the next vertex.
        Point p = point_at(positions, c == GHOST ? d : a);
        Point q = point_at(positions, c == GHOST ? b : c);
        Point r = point_at(positions, c == GHOST ? a : d);
        sign = orient2d(p, q, r);
        sign = sign == UNDECIDED ? sign : int(sign < 0);
    } else {
        sign = must_flip(point_at(positions, a), point_at(positions, b), point_at(positions, c), point_at(positions, d));
    }
    return sign == UNDECIDED ? OPEN : uint(sign);
}

#endif
