// Every vertex is named by its own point, and every point stands for itself, until others are found.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 order;
    WriteU32 names;
    WriteU32 representatives;
    uint count;
};

void main() {
    uint i = item_index();
    if (i < count) {
        names.at[i] = order.at[i];
        representatives.at[i] = i;
    }
}
