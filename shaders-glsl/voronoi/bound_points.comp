// Bounds of points, 1 of 2: every workgroup strides over all points and writes the bounds of those that it met.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "bounds.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32x4 points;
    WriteU64 partial;
    uint count;
};

// Ordered like the numbers; both zeros are one.
uint64_t ordered(uvec2 bits) {
    if ((bits.y & 0x7fffffffu) == 0u && bits.x == 0u) {
        bits.y = 0u;
    }
    uint64_t number = uint64_t(bits.y) << 32 | bits.x;
    return bits.y >> 31 != 0u ? ~number : number | 1UL << 63;
}

bool is_finite(uint high) {
    return (high >> 20 & 0x7ffu) != 0x7ffu;
}

void main() {
    uint stride = WORKGROUP * gl_NumWorkGroups.x;
    Bounds found = no_bounds();
    uint place = gl_WorkGroupID.x * WORKGROUP + gl_LocalInvocationIndex;
    // Looks at what is left, so that no index can pass 2^32.
    while (place < count) {
        uvec4 point = points.at[place];
        uint64_t x = ordered(point.xy);
        uint64_t y = ordered(point.zw);
        bool good_x = is_finite(point.y);
        uint64_t unfit = good_x && is_finite(point.w) ? ~0UL : uint64_t(place) << 1 | (good_x ? 1UL : 0UL);
        found = joined(found, Bounds(x, x, y, y, unfit));
        if (count - place <= stride) {
            break;
        }
        place += stride;
    }
    found = joined_in_group(found);
    if (gl_LocalInvocationIndex == 0u) {
        write_bounds(partial, gl_WorkGroupID.x, found);
    }
}
