// For every vertex a half-edge that leaves it, and how many do. Which half-edge it is depends on the order in which
// invocations come; what is made of it may not.
//
// Triangles next to each other in memory mostly share corners: a workgroup first counts by itself, in a small table of
// vertices, which leaves about a third of the accesses to memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"
#include "mesh.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 slots;
    WriteU32 spokes; // by vertex; all NONE before
    U32 degrees;     // all zero before
    uint limit;      // slots that there is memory for
    uint vertices;
};

// More than a workgroup has corners.
const uint TABLE = 4u * WORKGROUP;
shared uint vertex_of[TABLE];
shared uint spoke_of[TABLE];
shared uint count_of[TABLE];

void count(uint v, uint h) {
    uint place = (v * 0x9e3779b1u >> 8) % TABLE;
    for (uint probe = 0u; probe < TABLE; probe++) {
        uint holds = atomicCompSwap(vertex_of[place], NONE, v);
        if (holds == NONE || holds == v) {
            spoke_of[place] = h;
            atomicAdd(count_of[place], 1u);
            return;
        }
        place = (place + 1u) % TABLE;
    }
}

void main() {
    for (uint i = gl_LocalInvocationIndex; i < TABLE; i += WORKGROUP) {
        vertex_of[i] = NONE;
        count_of[i] = 0u;
    }
    barrier();
    uint t = item_index();
    if (t < min(slots.at[0], limit) && !is_deleted(triangles, t)) {
        uvec3 corner = corners(triangles, t);
        for (uint k = 0u; k < 3u; k++) {
            if (corner[k] < vertices) {
                count(corner[k], prev_edge(3u * t + k));
            }
        }
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < TABLE; i += WORKGROUP) {
        uint v = vertex_of[i];
        if (v != NONE) {
            spokes.at[v] = spoke_of[i];
            atomicAdd(degrees.at[v], count_of[i]);
        }
    }
}
