// Mapping, 3 of 7: the lowest index keeps a pixel, in the order of pixels that have points; a bit for each point that loses.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "ranks.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pixels;
    ReadU32 bits;
    ReadU32 ranks;
    U32 order; // NONE
    U32 lost;  // zeros, a bit a point
    uint width;
    uint count;
};

void main() {
    uint point = item_index();
    if (point >= count) {
        return;
    }
    uint number = number_of(bits, ranks, pixels.at[point], pitch_of(width));
    uint loser = point;
    // Whoever stands there can only give way to a lower index.
    if (order.at[number] > point) {
        uint before = atomicMin(order.at[number], point);
        loser = before == NONE ? NONE : max(before, point);
    }
    if (loser != NONE) {
        atomicOr(lost.at[loser >> 5], 1u << (loser & 31u));
    }
}
