// The working mesh on the device: two arrays of words, as `GhostMesh` of polder-mesh lays them out. `triangles.at[h]` is
// the corner opposite half-edge h = 3t + k; `links.at[h]` is the half-edge on its other side, with the mark of a
// constrained edge in the highest bit. A free slot has three corners DELETED and three links NONE.
//
// The arrays may be `U32` or `ReadU32`.
#ifndef MESH_GLSL
#define MESH_GLSL

#include "buffers.glsl"

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
#define origin(TRIANGLES, H) (TRIANGLES.at[next_edge(H)])
#define destination(TRIANGLES, H) (TRIANGLES.at[prev_edge(H)])
// The corners of slot t, in order.
#define corners(TRIANGLES, T) (uvec3(TRIANGLES.at[3u * (T)], TRIANGLES.at[3u * (T) + 1u], TRIANGLES.at[3u * (T) + 2u]))
#define is_deleted(TRIANGLES, T) (TRIANGLES.at[3u * (T)] == DELETED)
#define is_ghost(TRIANGLES, T) (any(equal(corners(TRIANGLES, T), uvec3(GHOST))))
#define is_finite(TRIANGLES, T) (all(lessThan(corners(TRIANGLES, T), uvec3(DELETED))))
// The other side of h, without the mark: HALF_EDGE in a free slot.
#define twin(LINKS, H) (LINKS.at[H] & HALF_EDGE)
#define is_constrained(LINKS, H) ((LINKS.at[H] & CONSTRAINED) != 0u)
// The next half-edges out of the same origin.
#define rotate_ccw(LINKS, H) (twin(LINKS, prev_edge(H)))
#define rotate_cw(LINKS, H) (next_edge(twin(LINKS, H)))

// Makes two half-edges each other's other side, of an edge that is not constrained.
void link(U32 links, uint g, uint h) {
    links.at[g] = h;
    links.at[h] = g;
}

// The same, with the mark that is given: CONSTRAINED or zero.
void link_marked(U32 links, uint g, uint h, uint mark) {
    links.at[g] = h | mark;
    links.at[h] = g | mark;
}

// Frees a slot.
void free_slot(U32 triangles, U32 links, uint t) {
    for (uint k = 0u; k < 3u; k++) {
        triangles.at[3u * t + k] = DELETED;
        links.at[3u * t + k] = NONE;
    }
}

// `GhostMesh::flip`: replaces the edge of h by the other diagonal of its two triangles, and returns the half-edge of the
// new edge in the triangle of h. The new edge is not constrained, the outer ones keep their marks. For one flip among
// triangles that nobody else changes; flips side by side update links in two steps.
uint flip_edge(U32 triangles, U32 links, uint h) {
    uint g = twin(links, h);
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint t_outer = links.at[h1];
    uint u_outer = links.at[g1];
    uint c = triangles.at[h];
    uint d = triangles.at[g];
    triangles.at[prev_edge(h)] = d;
    triangles.at[prev_edge(g)] = c;
    link_marked(links, h, u_outer & HALF_EDGE, u_outer & CONSTRAINED);
    link_marked(links, g, t_outer & HALF_EDGE, t_outer & CONSTRAINED);
    link(links, h1, g1);
    return h1;
}

#endif
