// Whether a colored pixel is its site's own or has a neighbor of its color that is closer to the site.
#ifndef CLOSER_GLSL
#define CLOSER_GLSL

#include "grid.glsl"

bool has_closer(ReadU32 colors, ReadU32 sites, uint index, uint width, uint height) {
    uint color = colors.at[index];
    uint pixel = pixel_at(index, width);
    uint site = sites.at[color];
    // Straight or diagonally toward the site: always closer, and nearly always of the same color.
    uint x = uint(int(pixel & 0xffffu) + sign(int(site & 0xffffu) - int(pixel & 0xffffu)));
    uint y = uint(int(pixel >> 16) + sign(int(site >> 16) - int(pixel >> 16)));
    if (colors.at[y * width + x] == color) {
        return true;
    }
    uvec3 key = key_of(pixel, site);
    for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, width, height);
        if (other != NONE && colors.at[index_of(other, width)] == color && before(key_of(other, site), key)) {
            return true;
        }
    }
    return false;
}

#endif
