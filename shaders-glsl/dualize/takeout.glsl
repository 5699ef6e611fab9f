// The outer edges of the stars that are cut in a round. Each triangle of a star has one, opposite the vertex: `edge_of` leads
// from the triangle to an entry of the list, which names the triangle and the half-edge where the edge is by now. What
// `edge_of` says of a triangle is true only if that entry names it: so nothing has to be cleared.
#ifndef TAKEOUT_GLSL
#define TAKEOUT_GLSL

#include "shift.glsl"

BUFFER(OuterEdges, uvec2, 8, );

#endif
