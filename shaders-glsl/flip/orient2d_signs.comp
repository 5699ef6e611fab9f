// The orientation of each triple of points: the bits of -1, 0 or 1; of UNDECIDED too, where only the filter is asked.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "groups.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32 triples;
    WriteU32 signs;
    uint count;
};

void main() {
    uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex;
    if (i >= count) {
        return;
    }
    Point p[3];
    for (uint k = 0u; k < 3u; k++) {
        p[k] = point_at(positions, triples.at[3u * i + k]);
    }
    signs.at[i] = uint(orient2d(p[0], p[1], p[2]));
}
