// Dualize, 2 of 3: how many triangles there will be: none if the diagram is not one that flooding gives.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 1) in;
#include "buffers.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 sites;
    ReadU32 total;
    ReadU32 crossing;
    ReadU32 uncolored;
    WriteU32 slots;
    uint limit; // slots that there is room for
};

void main() {
    const uint NONE = 0xffffffffu;
    uint count = sites.at[0];
    // A sphere of the sites and the ghost; one site alone has no edge and no triangle.
    uint expected = count < 2u ? 0u : 2u * count - 2u;
    bool is_good = crossing.at[0] == NONE && uncolored.at[0] == NONE && total.at[0] == expected && expected <= limit;
    slots.at[0] = is_good ? expected : 0u;
}
