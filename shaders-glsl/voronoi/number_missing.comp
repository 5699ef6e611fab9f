// Mapping, 7 of 7: puts the missing points, sorted, behind the sites.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pixels;
    ReadU32 missing;
    ReadU32 sites; // how many
    WriteU32 order;
    WriteU32 order_pixels;
    MaybeReadU32 counter;
    uint limit;
};

void main() {
    uint i = item_index();
    if (i < length_of(counter, limit)) {
        uint point = missing.at[i];
        uint to = sites.at[0] + i;
        order.at[to] = point;
        order_pixels.at[to] = pixels.at[point];
    }
}
