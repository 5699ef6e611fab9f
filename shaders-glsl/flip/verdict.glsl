// Step 1 of a round: whether an edge must be flipped.
#ifndef VERDICT_GLSL
#define VERDICT_GLSL

#include "predicates.glsl"
#include "rounds.glsl"

// The position of a corner; anything for the ghost vertex.
Point corner_at(ReadPoints positions, uint v) {
    Point point = Point(0u);
    if (v != GHOST) {
        point = point_at(positions, v);
    }
    return point;
}

// Of an edge from b to c that is not constrained, between the corners a, on its left, and d: `is_illegal` of the reference.
bool is_illegal(uint a, uint b, uint c, uint d, Point at_a, Point at_b, Point at_c, Point at_d) {
    if (a == d || a == GHOST || d == GHOST) {
        return false;
    }
    if (b == GHOST || c == GHOST) {
        // From v to the ghost, or back, in the ghost triangle of the hull edge from v to the next vertex.
        bool out_of = c == GHOST;
        Point first = out_of ? at_d : at_a;
        Point middle = out_of ? at_b : at_c;
        Point last = out_of ? at_a : at_d;
        return orient2d(first, middle, last) < 0;
    }
    return must_flip(at_a, at_b, at_c, at_d) != 0;
}

bool is_illegal(ReadPoints positions, uint a, uint b, uint c, uint d) {
    Point at_a = corner_at(positions, a);
    Point at_b = corner_at(positions, b);
    return is_illegal(a, b, c, d, at_a, at_b, corner_at(positions, c), corner_at(positions, d));
}

#endif
