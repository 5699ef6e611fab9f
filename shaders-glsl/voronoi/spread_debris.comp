// Repair, 2 of 4: what is debris because a neighbor has lost its color, of all debris that the turn before has listed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "repairs.glsl"

layout(push_constant, std430) uniform Args {
    SharedU32 colors;
    ReadU32 sites;
    U32 list;
    SharedU32 debris_bits;
    U32 counts; // of each turn, four words apart
    uint turn;  // the first is 1; what was marked is 0
    uint width;
    uint height;
};

void main() {
    uint begin = 0u;
    uint end = counts.at[0];
    for (uint i = 1u; i < turn; i++) {
        begin = end;
        end += counts.at[4u * i];
    }
    // An invocation for each neighbor.
    uint k = item_index() % 8u;
    for (uint i = begin + item_index() / 8u; i < end; i += WORKGROUP / 8u * gl_NumWorkGroups.x * gl_NumWorkGroups.y) {
        uint found = new_debris(colors, sites, debris_bits, list.at[i], k, uvec2(width, height));
        if (found != NONE) {
            list.at[end + atomicAdd(counts.at[4u * turn], 1u)] = found;
        }
    }
}
