// Whether the edge bc of the triangles abc and dcb must be flipped to ad, for each quadruple of points: 1 or 0. What is
// undecided is put on a list.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "count.glsl"
#include "groups.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32 quadruples;
    WriteU32 signs;
    // Which to look at; all if left out.
    MaybeReadU32 items;
    MaybeReadU32 counter;
    WriteU32 deferred;
    U32 deferred_count;
    uint limit;
};

void main() {
    uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex;
    if (i >= length_of(counter, limit)) {
        return;
    }
    uint item = present(items) ? items.at[i] : i;
    Point p[4];
    for (uint k = 0u; k < 4u; k++) {
        p[k] = point_at(positions, quadruples.at[4u * item + k]);
    }
    int sign = must_flip(p[0], p[1], p[2], p[3]);
    if (sign == UNDECIDED) {
        deferred.at[atomicAdd(deferred_count.at[0], 1u)] = item;
        return;
    }
    signs.at[item] = uint(sign);
}
