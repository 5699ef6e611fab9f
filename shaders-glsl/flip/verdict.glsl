// Step 1 of a round: whether an edge must be flipped.
#ifndef VERDICT_GLSL
#define VERDICT_GLSL

#include "predicates.glsl"
#include "rounds.glsl"

// Of an edge from b to c that is not constrained, between the corners a, on its left, and d: `is_illegal` of the reference.
bool is_illegal(ReadPoints positions, uint a, uint b, uint c, uint d) {
    if (a == d || a == GHOST || d == GHOST) {
        return false;
    }
    if (b == GHOST || c == GHOST) {
        // From v to the ghost, or back, in the ghost triangle of the hull edge from v to the next vertex.
        Point p = point_at(positions, c == GHOST ? d : a);
        Point q = point_at(positions, c == GHOST ? b : c);
        Point r = point_at(positions, c == GHOST ? a : d);
        return orient2d(p, q, r) < 0;
    }
    return must_flip(point_at(positions, a), point_at(positions, b), point_at(positions, c), point_at(positions, d)) != 0;
}

#endif
