// Insertion, before the rounds, 2 of 5: where no triangle is finite, the lexicographically first and last vertex of the
// mesh or, if it is empty, of all points; of equal ones the lowest. Two passes: each workgroup finds its two, then one
// workgroup the two of all. The second pass lays the chain of both if the mesh is empty.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32 half_edges;
    U32 ends; // two for each workgroup of the first pass
    U32 words;
    uint count; // points; of the second pass: ends
    uint last;  // whether it is the second pass
};

shared uvec2 found[WORKGROUP];

// The one that comes first, or with `down` last.
uint better(uint u, uint v, bool down) {
    if (u == NONE || v == NONE) {
        return u == NONE ? v : u;
    }
    int order = compare_points(point_at(positions, u), point_at(positions, v));
    order = down ? -order : order;
    return order == 0 ? min(u, v) : order < 0 ? u : v;
}

// The chain of two points. Its triangles take the slots of the one that has some, and point 0 those of the other.
void lay(uint a, uint b) {
    uint keeps = a == 0u ? b : a;
    uint gives = a + b - keeps;
    uint s = 2u * keeps - 2u;
    uint t = s + 1u;
    set_corners(triangles, s, b, a, GHOST);
    set_corners(triangles, t, a, b, GHOST);
    note_of(links, s) = NONE;
    note_of(links, t) = NONE;
    link(links, 3u * s + 2u, 3u * t + 2u);
    link(links, 3u * s, 3u * t + 1u);
    link(links, 3u * s + 1u, 3u * t);
    words.at[SITES] = 0u;
    if (gives != 0u) {
        words.at[GIVEN] = 2u * gives - 2u;
        words.at[GIVEN + 1u] = 2u * gives - 1u;
    }
}

void main() {
    if (words.at[CENTER_SLOT] != NONE) {
        return;
    }
    bool all = words.at[CHAIN] == 0u;
    uvec2 best = uvec2(NONE);
    uint rank = gl_LocalInvocationIndex;
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint v = last != 0u ? ends.at[i] : all || half_edges.at[i] != NONE ? i : NONE;
        best = uvec2(better(best.x, v, false), better(best.y, v, true));
    }
    found[rank] = best;
    for (uint width = WORKGROUP / 2u; width > 0u; width /= 2u) {
        barrier();
        if (rank < width) {
            uvec2 other = found[rank + width];
            found[rank] = uvec2(better(found[rank].x, other.x, false), better(found[rank].y, other.y, true));
        }
    }
    if (rank != 0u) {
        return;
    }
    best = found[0];
    if (last == 0u) {
        ends.at[2u * group_index()] = best.x;
        ends.at[2u * group_index() + 1u] = best.y;
        return;
    }
    words.at[ENDS] = best.x;
    words.at[ENDS + 1u] = best.y;
    if (all && best.x != NONE && !same_point(point_at(positions, best.x), point_at(positions, best.y))) {
        lay(best.x, best.y);
    }
}
