// Step 2 of an inner round: which pairs may be flipped.
#ifndef CANDIDATES_GLSL
#define CANDIDATES_GLSL

#include "pairs.glsl"
#include "predicates.glsl"

// Whether the quadrilateral near, right, far, left is strictly convex at right and left. Called from one place.
bool is_convex(Point near, Point right, Point far, Point left) {
    [[dont_unroll]] for (uint turn = 0u; turn < 2u; turn++) {
        if (orient2d(near, right, far) <= 0) {
            return false;
        }
        Point point = near;
        near = far;
        far = point;
        right = left;
    }
    return true;
}

// Whether the pair of triangle A and the next one of its owner may be flipped, and in which case. Links may be those before
// or after they were renewed.
Candidate candidate(
    MESH triangles, MESH links, ReadPoints positions, WORDS state, uint round, uint a
) {
    uint word = state.at[OWNED(a)];
    uint out_of = outward(word);
    if (word == FREE || out_of == NO_EDGE) {
        return NO_PAIR;
    }
    uint h = 3u * a + out_of;
    uint g = resolved(links, state, round, h);
    uint next_word = state.at[OWNED(g / 3u)];
    if (!same_owner(word, next_word)) {
        return NO_PAIR;
    }
    uint into = inward(word);
    int side = side_of(word);
    int far_side = side_of(next_word);
    bool turns = side * far_side < 0;
    // The pair itself, the one before it, and the one that would then be before it.
    uvec4 row = FOUR_WORDS(triangles)[2u * a].row;
    Point near = point_at(positions, pick(row, out_of));
    Point right = point_at(positions, pick(row, turned(out_of, 1u)));
    Point left = point_at(positions, pick(row, turned(out_of, 2u)));
    Point far = point_at(positions, apex(triangles, g));
    Point beyond = far;
    int before_side = 0;
    uint b = NO_B;
    uint kind = 0u;
    bool concave = false;
    [[dont_unroll]] for (uint look = 0u; look < 3u; look++) {
        bool convex = is_convex(near, right, far, left);
        if (look == 0u) {
            if (!convex) {
                break;
            }
            if (!turns) {
                kind = 1u;
                break;
            }
            // A pair of this kind is not the first of its chain.
            uint entry = resolved(links, state, round, 3u * a + into);
            uint before_word = state.at[OWNED(entry / 3u)];
            if (!same_owner(word, before_word)) {
                break;
            }
            b = entry / 3u;
            before_side = side_of(before_word);
            // The third corner is the one opposite the edge of entry.
            bool lone_is_right = out_of == turned(into, 1u);
            Point third = lone_is_right ? left : right;
            Point lone = lone_is_right ? right : left;
            // Across the edge of entry from B: right of the line its origin there.
            Point entry_right = lone_is_right ? lone : near;
            Point entry_left = lone_is_right ? near : lone;
            near = point_at(positions, apex(triangles, entry));
            right = entry_right;
            left = entry_left;
            far = third;
        } else if (look == 1u) {
            concave = !convex;
            if (convex && before_side * side >= 0) {
                break;
            }
            far = beyond;
        } else if (convex && (concave || before_side * far_side >= 0)) {
            kind = concave ? 3u : 2u;
        }
    }
    if (kind == 0u) {
        return NO_PAIR;
    }
    return Candidate(a, g / 3u, uvec2(h, (kind - 1u) << CLAIM_BITS | (kind == 1u ? NO_B : b)));
}

#endif
