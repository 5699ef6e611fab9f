// How many edges of the result are constrained: each is counted in the lower of its triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_arithmetic : require

layout(push_constant, std430) uniform Args {
    ReadU32 constrained; // four triangles a word
    ReadU32 neighbors;
    U32 edges;
    MaybeReadU32 counter; // of triangles
    uint limit;
};

void main() {
    uint i = item_index();
    uint end = length_of(counter, limit);
    uint found = 0u;
    uint bits = 4u * i < end ? constrained.at[i] : 0u;
    while (bits != 0u) {
        uint bit = findLSB(bits);
        bits &= bits - 1u;
        uint t = 4u * i + bit / 8u;
        if (t < end && bit % 8u < 3u) {
            found += uint(neighbors.at[3u * t + bit % 8u] > t);
        }
    }
    uint sum = subgroupAdd(found);
    if (sum != 0u && subgroupElect()) {
        atomicAdd(edges.at[0], sum);
    }
}
