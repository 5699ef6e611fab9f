// Mapping, 3 of 5: puts each site at its number, which is how many pixels before its own have an owner.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pixels;
    ReadU32 owner;
    ReadU32 number;
    WriteU32 order;
    WriteU32 order_pixels;
    uint width;
    uint count;
};

void main() {
    uint point = item_index();
    if (point >= count) {
        return;
    }
    uint pixel = pixels.at[point];
    uint index = index_of(pixel, width);
    if (owner.at[index] == point) {
        uint to = number.at[index];
        order.at[to] = point;
        order_pixels.at[to] = pixel;
    }
}
