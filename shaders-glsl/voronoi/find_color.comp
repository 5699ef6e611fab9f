// Recoloring, 1 of 2: the best color on offer to each debris pixel: of its neighbors that are closer to their site than it
// is, the one whose site comes first for the pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 sites;
    ReadU32 debris;
    WriteU32 found;
    ReadU32 count;
    uint width;
    uint height;
};

void main() {
    uint i = item_index();
    if (i >= count.at[0]) {
        return;
    }
    uint pixel = pixel_at(debris.at[i], width);
    uvec3 best = uvec3(NONE);
    uint best_color = UNCOLORED;
    for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, width, height);
        uint color = other == NONE ? UNCOLORED : colors.at[index_of(other, width)];
        if (color == UNCOLORED) {
            continue;
        }
        uint site = sites.at[color];
        uvec3 key = key_of(pixel, site);
        if (before(key_of(other, site), key) && before(key, best)) {
            best = key;
            best_color = color;
        }
    }
    found.at[i] = best_color;
}
