// Repair, 1 of 4: lists the debris that was marked, in the order of arrival, and takes its color.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 any_debris;
    ReadU32 debris_bits;
    WriteU32 colors;
    WriteU32 list;
    U32 count;
    uint words;
};

void main() {
    uint word = item_index();
    if (word >= words || any_debris.at[0] == 0u) {
        return;
    }
    uint left = debris_bits.at[word];
    if (left == 0u) {
        return;
    }
    uint to = atomicAdd(count.at[0], uint(bitCount(left)));
    while (left != 0u) {
        uint index = word * 32u + uint(findLSB(left));
        list.at[to] = index;
        colors.at[index] = UNCOLORED;
        to++;
        left &= left - 1u;
    }
}
