// Debris, 1 of 3: marks every pixel that has no closer neighbor of its own color, and appends it to the debris. The order
// of what is appended is that of arrival, and no result depends on it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "closer.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 sites;
    WriteU32 state;
    WriteU32 debris;
    U32 total;
    U32 marked;
    uint width;
    uint height;
};

void main() {
    uint index = item_index();
    if (index >= width * height) {
        return;
    }
    bool keeps = has_closer(colors, sites, index, width, height);
    state.at[index] = keeps ? 0u : 1u;
    if (!keeps) {
        debris.at[atomicAdd(total.at[0], 1u)] = index;
        atomicAdd(marked.at[0], 1u);
    }
}
