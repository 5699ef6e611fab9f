// Whether the edge bc of the triangles abc and dcb must be flipped to ad, for each quadruple of points: 1 or 0; or
// UNDECIDED, where only the filter is asked.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "groups.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32 quadruples;
    WriteU32 signs;
    uint count;
};

void main() {
    uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex;
    if (i >= count) {
        return;
    }
    Point p[4];
    for (uint k = 0u; k < 4u; k++) {
        p[k] = point_at(positions, quadruples.at[4u * i + k]);
    }
    signs.at[i] = uint(must_flip(p[0], p[1], p[2], p[3]));
}
