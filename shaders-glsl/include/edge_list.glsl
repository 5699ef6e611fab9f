// Lists of edges to be tested in the next flip round (`polder_flip::gpu::EdgeList`): half-edges in any order, from either
// side; whether edges may repeat, is for the round to say.
#ifndef EDGE_LIST_GLSL
#define EDGE_LIST_GLSL

#include "buffers.glsl"

// Appends an edge by one of its half-edges. What does not fit is counted all the same, which the host can see.
void append_edge(WriteU32 edges, U32 count, uint limit, uint h) {
    uint place = atomicAdd(count.at[0], 1u);
    if (place < limit) {
        edges.at[place] = h;
    }
}

// Appends the three edges of a triangle.
void append_triangle(WriteU32 edges, U32 count, uint limit, uint t) {
    uint place = atomicAdd(count.at[0], 3u);
    for (uint k = 0u; k < 3u; k++) {
        if (place + k < limit) {
            edges.at[place + k] = 3u * t + k;
        }
    }
}

#endif
