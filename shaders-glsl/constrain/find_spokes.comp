// For every vertex a half-edge that leaves it, and how many do. Which half-edge it is depends on the order in which
// invocations come; what is made of it may not.
//
// Counting in a table of the workgroup first, a third of the accesses to memory, took a fifth longer.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "mesh.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadU32 slots;
    WriteU32 spokes; // by vertex; all NONE before
    U32 degrees;     // all zero before
    uint limit;      // slots that there is memory for
    uint vertices;
};

void main() {
    uint t = item_index();
    if (t >= min(slots.at[0], limit) || is_deleted(triangles, t)) {
        return;
    }
    uvec3 corner = corners(triangles, t);
    for (uint k = 0u; k < 3u; k++) {
        if (corner[k] < vertices) {
            spokes.at[corner[k]] = prev_edge(3u * t + k);
            atomicAdd(degrees.at[corner[k]], 1u);
        }
    }
}
