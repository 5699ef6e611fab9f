// Bounds of points, 2 of 2: one workgroup joins what the others found.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "bounds.glsl"

layout(push_constant, std430) uniform Args {
    ReadU64 partial;
    WriteU64 bounds;
    uint count;
};

void main() {
    Bounds found = no_bounds();
    for (uint place = gl_LocalInvocationIndex; place < count; place += WORKGROUP) {
        uint first = 5u * place;
        found = joined(found, Bounds(partial.at[first], partial.at[first + 1u], partial.at[first + 2u],
                                     partial.at[first + 3u], partial.at[first + 4u]));
    }
    found = joined_in_group(found);
    if (gl_LocalInvocationIndex == 0u) {
        write_bounds(bounds, 0u, found);
    }
}
