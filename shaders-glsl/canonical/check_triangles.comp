// The certificate's look at each triangle: links that do not lead back, finite triangles that are not counterclockwise, ghost
// triangles where the hull turns right or folds back: the lowest slot of each; and the lowest corners of the hull, counted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    U32 minima;
    U32 broken;
    U32 clockwise;
    U32 reflex;
    ReadU32 finite; // how many finite triangles there are
    ReadU32 slot_count;
    uint limit;
    uint vertices;
};

bool leads_back(uint h) {
    uint g = twin(links, h);
    if (g / 3u >= min(slot_count.at[0], limit) || link_of(links, g) != (h | (link_of(links, h) & CONSTRAINED))) {
        return false;
    }
    // Of two half-edges that lead to each other, one asks for both.
    return g < h
        || (origin(triangles, h) == destination(triangles, g) && destination(triangles, h) == origin(triangles, g));
}

void main() {
    uint t = item_index();
    if (t >= min(slot_count.at[0], limit) || is_deleted(triangles, t)) {
        return;
    }
    if (!leads_back(3u * t) || !leads_back(3u * t + 1u) || !leads_back(3u * t + 2u)) {
        atomicMin(broken.at[0], t);
        return;
    }
    uvec3 v = corners(triangles, t);
    bool ghost = any(equal(v, uvec3(GHOST)));
    if (ghost) {
        // The hull runs from v.x to v.y along h, and on to v.z.
        uint h = 3u * t + (v.x == GHOST ? 0u : v.y == GHOST ? 1u : 2u);
        uint following = prev_edge(twin(links, prev_edge(h)));
        v = uvec3(destination(triangles, h), origin(triangles, h), origin(triangles, following));
    }
    if (any(greaterThanEqual(v, uvec3(vertices)))) {
        atomicMin(broken.at[0], t);
        return;
    }
    Point p = point_at(positions, v.x);
    Point q = point_at(positions, v.y);
    Point r = point_at(positions, v.z);
    int turn = v.x == v.z ? 0 : orient2d(p, q, r);
    if (!ghost) {
        if (turn <= 0) {
            atomicMin(clockwise.at[0], t);
        }
        return;
    }
    int before = compare_points(p, q);
    int after = compare_points(q, r);
    if (before > 0 && after < 0) {
        atomicAdd(minima.at[0], 1u);
    }
    bool folds = turn == 0 && (before < 0) != (after < 0);
    if (turn < 0 || (folds && (finite.at[0] != 0u || v.x != v.z))) {
        atomicMin(reflex.at[0], t);
    }
}
