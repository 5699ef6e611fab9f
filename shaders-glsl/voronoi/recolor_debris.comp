// Repair, 3 of 4: each pixel of a list takes the best color on offer; where that changes it the debris around it goes to the
// next list. Only if all debris has been found.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "repairs.glsl"

layout(push_constant, std430) uniform Args {
    SharedU32 colors;
    ReadU32 sites;
    ReadU32 list;
    ReadU32 count;
    WriteU32 next_list;
    U32 next_count;
    SharedU32 debris_bits;
    SharedU32 listed_bits; // of this list
    SharedU32 next_bits;
    ReadU32 phase; // 1: all found
    uint width;
    uint height;
};

void main() {
    uint end = phase.at[0] == 1u ? count.at[0] : 0u;
    for (uint i = item_index(); i < end; i += WORKGROUP * gl_NumWorkGroups.x * gl_NumWorkGroups.y) {
        uint index = list.at[i];
        atomicAnd(listed_bits.at[index >> 5], ~(1u << (index & 31u)));
        uint listed = recolor(colors, sites, debris_bits, next_bits, index, uvec2(width, height));
        uint to = listed == 0u ? 0u : atomicAdd(next_count.at[0], uint(bitCount(listed)));
        while (listed != 0u) {
            uint k = uint(findLSB(listed));
            next_list.at[to] = index_of(neighbor(pixel_at(index, width), k, width, height), width);
            to++;
            listed &= listed - 1u;
        }
    }
}
