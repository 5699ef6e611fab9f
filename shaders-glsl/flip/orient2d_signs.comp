// The orientation of each triple of points: the bits of -1, 0 or 1. What is undecided is put on a list.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "count.glsl"
#include "groups.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32 triples;
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
    Point p[3];
    for (uint k = 0u; k < 3u; k++) {
        p[k] = point_at(positions, triples.at[3u * item + k]);
    }
    int sign = orient2d(p[0], p[1], p[2]);
    if (sign == UNDECIDED) {
        deferred.at[atomicAdd(deferred_count.at[0], 1u)] = item;
        return;
    }
    signs.at[item] = uint(sign);
}
