// Mapping, 2 of 5: a one at each owned pixel (where zeros stood), and a flag for each point that does not own its pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pixels;
    ReadU32 owner;
    WriteU32 owned;
    WriteU32 lost;
    uint width;
    uint count;
};

void main() {
    uint point = item_index();
    if (point >= count) {
        return;
    }
    uint index = index_of(pixels.at[point], width);
    bool wins = owner.at[index] == point;
    lost.at[point] = wins ? 0u : 1u;
    if (wins) {
        owned.at[index] = 1u;
    }
}
