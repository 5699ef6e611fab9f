// Fills words with one value: a fill that a dispatch of no workgroups can leave out, as the fill command cannot be.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "groups.glsl"

layout(push_constant, std430) uniform Args {
    WriteU32 to;
    uint value;
    uint count;
};

const uint STEPS = 4u;

void main() {
    uint fours = count / 4u;
    uint first = group_index() * STEPS * WORKGROUP + gl_LocalInvocationIndex;
    [[unroll]] for (uint j = 0u; j < STEPS; j++) {
        uint i = first + j * WORKGROUP;
        if (i < fours) {
            WriteU32x4(to).at[i] = uvec4(value);
        }
    }
    if (first < count % 4u) {
        to.at[fours * 4u + first] = value;
    }
}
