// The working mesh on the device, as `GhostMesh` of polder-mesh has it: for half-edge h = 3t + k the corner opposite, among
// `triangles`, and among `links` the half-edge on its other side, with the mark of a constrained edge in the highest bit. A
// free slot has three corners DELETED and three links NONE.
//
// Both are of the types below. How they lie in memory is known here alone: all else goes through these macros.
#ifndef MESH_GLSL
#define MESH_GLSL

#include "buffers.glsl"

BUFFER(Rows, uint, 4, );
BUFFER(ReadRows, uint, 4, readonly);
BUFFER(WriteRows, uint, 4, writeonly);
BUFFER(SharedRows, uint, 4, coherent);

const uint CONSTRAINED = 0x80000000u;
const uint HALF_EDGE = 0x7fffffffu;
// No half-edge, no triangle, no claim.
const uint NONE = 0xffffffffu;
// Corners: the vertex at infinity, and what a free slot has.
const uint GHOST = 0xffffffffu;
const uint DELETED = 0xfffffffeu;

// The next and the previous half-edge of the same triangle, counterclockwise.
uint next_edge(uint h) {
    return h % 3u == 2u ? h - 2u : h + 1u;
}

uint prev_edge(uint h) {
    return h % 3u == 0u ? h + 2u : h - 1u;
}

// The order in which conflicts are settled: the least of all that claim a triangle gets it. A bijection.
uint priority(uint id) {
    uint x = id;
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// These are macros since no function can take arrays of two kinds; arguments are evaluated more than once.
#define apex(TRIANGLES, H) (TRIANGLES.at[H])
#define set_apex(TRIANGLES, H, V) TRIANGLES.at[H] = V
#define origin(TRIANGLES, H) (apex(TRIANGLES, next_edge(H)))
#define destination(TRIANGLES, H) (apex(TRIANGLES, prev_edge(H)))
// The corners of slot t, in order.
#define corners(TRIANGLES, T) (uvec3(TRIANGLES.at[3u * (T)], TRIANGLES.at[3u * (T) + 1u], TRIANGLES.at[3u * (T) + 2u]))
#define set_corners(TRIANGLES, T, A, B, C) \
    TRIANGLES.at[3u * (T)] = A;            \
    TRIANGLES.at[3u * (T) + 1u] = B;       \
    TRIANGLES.at[3u * (T) + 2u] = C
#define is_deleted(TRIANGLES, T) (apex(TRIANGLES, 3u * (T)) == DELETED)
#define is_ghost(TRIANGLES, T) (any(equal(corners(TRIANGLES, T), uvec3(GHOST))))
#define is_finite(TRIANGLES, T) (all(lessThan(corners(TRIANGLES, T), uvec3(DELETED))))
// The other side of h, with the mark; and those of slot t.
#define link_of(LINKS, H) (LINKS.at[H])
#define set_link(LINKS, H, V) LINKS.at[H] = V
#define links_of(LINKS, T) (uvec3(LINKS.at[3u * (T)], LINKS.at[3u * (T) + 1u], LINKS.at[3u * (T) + 2u]))
#define set_links(LINKS, T, A, B, C) set_corners(LINKS, T, A, B, C)
// The other side of h, without the mark: HALF_EDGE in a free slot.
#define twin(LINKS, H) (link_of(LINKS, H) & HALF_EDGE)
#define is_constrained(LINKS, H) ((link_of(LINKS, H) & CONSTRAINED) != 0u)
// The next half-edges out of the same origin.
#define rotate_ccw(LINKS, H) (twin(LINKS, prev_edge(H)))
#define rotate_cw(LINKS, H) (next_edge(twin(LINKS, H)))

// Makes two half-edges each other's other side, of an edge that is not constrained.
void link(Rows links, uint g, uint h) {
    set_link(links, g, h);
    set_link(links, h, g);
}

// The same, with the mark that is given: CONSTRAINED or zero.
void link_marked(Rows links, uint g, uint h, uint mark) {
    set_link(links, g, h | mark);
    set_link(links, h, g | mark);
}

// Frees a slot.
void free_slot(Rows triangles, Rows links, uint t) {
    set_corners(triangles, t, DELETED, DELETED, DELETED);
    set_links(links, t, NONE, NONE, NONE);
}

// `GhostMesh::flip`: replaces the edge of h by the other diagonal of its two triangles, and returns the half-edge of the
// new edge in the triangle of h. The new edge is not constrained, the outer ones keep their marks. For one flip among
// triangles that nobody else changes; flips side by side update links in two steps.
uint flip_edge(Rows triangles, Rows links, uint h) {
    uint g = twin(links, h);
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint t_outer = link_of(links, h1);
    uint u_outer = link_of(links, g1);
    uint c = apex(triangles, h);
    uint d = apex(triangles, g);
    set_apex(triangles, prev_edge(h), d);
    set_apex(triangles, prev_edge(g), c);
    link_marked(links, h, u_outer & HALF_EDGE, u_outer & CONSTRAINED);
    link_marked(links, g, t_outer & HALF_EDGE, t_outer & CONSTRAINED);
    link(links, h1, g1);
    return h1;
}

#endif
