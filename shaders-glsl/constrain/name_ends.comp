// Names, 2 of 2: the ends of the constraints as vertices.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "buffers.glsl"

BUFFER(ReadU32x2, uvec2, 8, readonly);
BUFFER(WriteU32x2, uvec2, 8, writeonly);

layout(push_constant, std430) uniform Args {
    ReadU32 vertices;
    ReadU32x2 constraints;
    WriteU32x2 ends;
    uint count;
    uint points;
};

void main() {
    uint i = item_index();
    if (i < count) {
        uvec2 c = min(constraints.at[i], uvec2(points - 1u));
        ends.at[i] = min(uvec2(vertices.at[c.x], vertices.at[c.y]), uvec2(points - 1u));
    }
}
