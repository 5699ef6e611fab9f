// Repair, 2 of 4: what is debris because a neighbor has lost its color, of all debris that was marked first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "repairs.glsl"

layout(push_constant, std430) uniform Args {
    SharedU32 colors;
    ReadU32 sites;
    U32 list;
    SharedU32 debris_bits;
    U32 count;
    ReadU32 first_count;
    uint width;
    uint height;
};

void main() {
    // An invocation for each neighbor.
    uint end = first_count.at[0];
    uint k = item_index() % 8u;
    for (uint i = item_index() / 8u; i < end; i += WORKGROUP / 8u * gl_NumWorkGroups.x * gl_NumWorkGroups.y) {
        uint found = new_debris(colors, sites, debris_bits, list.at[i], k, uvec2(width, height));
        if (found != NONE) {
            list.at[atomicAdd(count.at[0], 1u)] = found;
        }
    }
}
