// The working mesh on the device, as `GhostMesh` of polder-mesh has it: for half-edge h = 3t + k the corner opposite, among
// `triangles`, and among `links` the half-edge on its other side, with the mark of a constrained edge in the highest bit. A
// free slot has three corners DELETED and three links NONE.
//
// A triangle is a record of eight words, one sector of memory: corners in the first three, links from the fifth on. The fourth
// and the last are for notes of the stages, and NONE in a new triangle: see `note_of`. `triangles` is where records begin, `links` 16 bytes behind. How this lies in memory is known here alone, and
// in `Mesh` of polder-flip: all else goes through what is below, which reaches more than 4 GiB.
#ifndef MESH_GLSL
#define MESH_GLSL

#include "buffers.glsl"

#extension GL_EXT_buffer_reference2 : require

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

// Places of a triangle, and what stands there in four words at once.
uint turned(uint k, uint by) {
    k += by;
    return k >= 3u ? k - 3u : k;
}

uint pick(uvec4 row, uint k) {
    return k == 0u ? row.x : k == 1u ? row.y : row.z;
}

uvec4 replaced(uvec4 row, uint k, uint with) {
    return uvec4(k == 0u ? with : row.x, k == 1u ? with : row.y, k == 2u ? with : row.z, row.w);
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

// Where the word of half-edge h lies, from either address.
uint word_of(uint h) {
    return h + h / 3u * 5u;
}

#define MESH_WORDS(NAME, ACCESS)                                                        \
    layout(buffer_reference, std430, buffer_reference_align = 4) ACCESS buffer NAME { \
        uint word;                                                                    \
    }
MESH_WORDS(Rows, );
MESH_WORDS(ReadRows, readonly);
MESH_WORDS(WriteRows, writeonly);
MESH_WORDS(SharedRows, coherent);
// Four words at once: the corners or the links of a slot, and the note behind them. The first is not for what other
// invocations of the same dispatch write.
layout(buffer_reference, std430, buffer_reference_align = 16) buffer FourWords {
    uvec4 row;
};
layout(buffer_reference, std430, buffer_reference_align = 16) coherent buffer SharedFourWords {
    uvec4 row;
};

// These are macros since no function can take arrays of two kinds. The corner opposite half-edge h, and the ends of its edge.
#define apex(TRIANGLES, H) (TRIANGLES[word_of(H)].word)
#define set_apex(TRIANGLES, H, V) TRIANGLES[word_of(H)].word = V
#define origin(TRIANGLES, H) (apex(TRIANGLES, next_edge(H)))
#define destination(TRIANGLES, H) (apex(TRIANGLES, prev_edge(H)))
// The corners of slot t, in order, and what they say.
#define corners(TRIANGLES, T) (uvec3(FourWords(TRIANGLES)[2u * (T)].row))
#define set_corners(TRIANGLES, T, A, B, C) FourWords(TRIANGLES)[2u * (T)].row = uvec4(A, B, C, NONE)
// The word behind the corners of slot t, or behind its links. Where new corners or links are set, it becomes NONE.
#define note_of(ROWS, T) (ROWS[8u * (T) + 3u].word)
#define is_deleted(TRIANGLES, T) (TRIANGLES[8u * (T)].word == DELETED)
#define is_ghost(TRIANGLES, T) (any(equal(corners(TRIANGLES, T), uvec3(GHOST))))
#define is_finite(TRIANGLES, T) (all(lessThan(corners(TRIANGLES, T), uvec3(DELETED))))
// The other side of h, with the mark; and those of slot t.
#define link_of(LINKS, H) (LINKS[word_of(H)].word)
#define set_link(LINKS, H, V) LINKS[word_of(H)].word = V
#define links_of(LINKS, T) (uvec3(FourWords(LINKS)[2u * (T)].row))
#define set_links(LINKS, T, A, B, C) set_corners(LINKS, T, A, B, C)
#define set_links_noted(LINKS, T, A, B, C, NOTE) FourWords(LINKS)[2u * (T)].row = uvec4(A, B, C, NOTE)
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
