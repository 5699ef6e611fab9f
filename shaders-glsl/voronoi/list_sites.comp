// Mapping, 4 of 7: the pixels of the sites, in order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    ReadU32 ranks;
    WriteU32 order_pixels;
    uint width;
    uint height;
};

void main() {
    uint word = item_index();
    uint pitch = pitch_of(width);
    if (word >= pitch * height) {
        return;
    }
    uint first = pixel_at(word, pitch);
    first = (first & 0xffff0000u) | (first & 0xffffu) << 5;
    uint to = ranks.at[word];
    uint left = bits.at[word];
    while (left != 0u) {
        order_pixels.at[to] = first + uint(findLSB(left));
        to++;
        left &= left - 1u;
    }
}
