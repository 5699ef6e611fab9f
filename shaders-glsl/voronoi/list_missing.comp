// Mapping, 6 of 7: the missing points in the order that they came in, and what they are to be sorted by: the number of the
// site in their pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "ranks.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 lost;
    ReadU32 lost_ranks;
    ReadU32 pixels;
    ReadU32 bits;
    ReadU32 ranks;
    WriteU32 missing;
    WriteU32 keys;
    uint width;
    uint count; // of points
};

void main() {
    uint point = item_index();
    if (point >= count) {
        return;
    }
    uint word = lost.at[point >> 5];
    if ((word >> (point & 31u) & 1u) != 0u) {
        uint to = lost_ranks.at[point >> 5] + uint(bitCount(word & below(point)));
        missing.at[to] = point;
        keys.at[to] = number_of(bits, ranks, pixels.at[point], pitch_of(width));
    }
}
