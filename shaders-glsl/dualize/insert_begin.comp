// Insertion, before the rounds, 1 of 5: some half-edge out of each vertex, the lowest finite triangle, and no point is a
// duplicate yet.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#extension GL_KHR_shader_subgroup_arithmetic : require

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadU32 slots;
    WriteU32 half_edges; // by vertex; all NONE before
    WriteU32 vertex_of;
    ReadU32 sites;       // points below this number have slots that were freed
    U32 words;           // CENTER_SLOT, APEX, ENDS and GIVEN are NONE before, all else zero
    uint limit;          // slots that there is memory for
    uint vertices;
};

void main() {
    uint t = item_index();
    uint least = NONE;
    if (t < min(slots.at[0], limit) && !is_deleted(triangles, t)) {
        uvec3 corner = corners(triangles, t);
        for (uint k = 0u; k < 3u; k++) {
            // Of all that write here any may be the last: a walk ends at the same place wherever it starts.
            if (corner[k] < vertices) {
                half_edges.at[corner[k]] = prev_edge(3u * t + k);
            }
        }
        least = is_finite(triangles, t) ? t : NONE;
        if (words.at[CHAIN] == 0u) {
            words.at[CHAIN] = 1u;
        }
    }
    if (t < vertices) {
        vertex_of.at[t] = t;
    }
    if (t == 0u) {
        words.at[SITES] = min(sites.at[0], vertices);
    }
    least = subgroupMin(least);
    if (subgroupElect() && least < words.at[CENTER_SLOT]) {
        atomicMin(words.at[CENTER_SLOT], least);
    }
}
