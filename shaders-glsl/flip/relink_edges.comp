// Step 3 of a round, second half, and step 4: renews the links around all flips, gives claimed triangles back, and lists the
// edges of the next round: those around flips, and illegal ones next to no flip. No edge is listed twice.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    U32 triangles;
    U32 links;
    U32 claims;
    U32 stamps;
    ReadU32 illegal;
    WriteU32 edges;
    U32 edge_count;
    MaybeWriteU32 also; // another list that they are appended to
    MaybeU32 also_count;
    U32 words;
    uint also_limit;
};

shared uvec2 places;

void main() {
    uint end = words.at[RELINK_COUNT];
    uint round = words.at[ROUND];
    if (item_index() == 0u) {
        words.at[ILLEGAL_COUNT] = 0u;
        words.at[TAKEN_COUNT] = 0u;
    }
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        Handed handed;
        handed.count = 0u;
        if (i < end) {
            uint h = illegal.at[i];
            if ((h & WON) != 0u) {
                handed = relink(triangles, links, claims, stamps, round, h & HALF_EDGE);
            } else {
                handed = leave(links, claims, stamps, round, h);
            }
        }
        uint total;
        uint before = sum_before(handed.count, total);
        if (gl_LocalInvocationIndex == 0u && total != 0u) {
            places.x = atomicAdd(edge_count.at[0], total);
            if (present(also)) {
                places.y = atomicAdd(also_count.at[0], total);
            }
        }
        barrier();
        for (uint k = 0u; k < handed.count; k++) {
            edges.at[places.x + before + k] = handed.edges[k];
            if (present(also) && places.y + before + k < also_limit) {
                also.at[places.y + before + k] = handed.edges[k];
            }
        }
    }
}
