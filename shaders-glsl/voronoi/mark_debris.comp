// Coloring, 8 of 8: marks every pixel of the tiles that were left that has no closer neighbor of its own color, as
// debris.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tiles.glsl"
#include "closer.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 sites;
    ReadU32 left;
    ReadU32 left_count;
    U32 debris_bits;
    WriteU32 any_debris;
    uint width;
    uint height;
};

void main() {
    if (group_index() >= left_count.at[0]) {
        return;
    }
    uint tile = left.at[group_index()];
    uint across = tiles_across(width);
    for (uint i = gl_LocalInvocationIndex; i < TILE_WIDTH * TILE_HEIGHT; i += WORKGROUP) {
        uint x = tile % across * TILE_WIDTH + i % TILE_WIDTH;
        uint y = tile / across * TILE_HEIGHT + i / TILE_WIDTH;
        uint index = y * width + x;
        if (x < width && y < height && !has_closer(colors, sites, index, width, height)) {
            any_debris.at[0] = 1u;
            atomicOr(debris_bits.at[index >> 5], 1u << (index & 31u));
        }
    }
}
