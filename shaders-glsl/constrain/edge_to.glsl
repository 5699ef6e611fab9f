// Whether two vertices are joined by an edge.
#ifndef EDGE_TO_GLSL
#define EDGE_TO_GLSL

#include "mesh.glsl"

// The half-edge to a vertex among those that leave the origin of `spoke`, or NONE. `most` bounds the turn.
uint edge_to(uint spoke, uint to, uint most, ReadRows triangles, ReadRows links) {
    uint h = spoke;
    uint w = destination(triangles, h);
    for (uint turn = 0u; turn < most; turn++) {
        if (w == to) {
            return h;
        }
        w = apex(triangles, h);
        h = rotate_ccw(links, h);
        if (h == spoke || h == HALF_EDGE) {
            break;
        }
    }
    return NONE;
}

#endif
