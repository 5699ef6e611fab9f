// What the kernels that repair debris do to one pixel. Waiting for memory is what takes time in them: so all neighbors are
// asked for at once, and none is left out by a branch.
//
// Colors are read and written in place: of what is done at the same time some see what others have changed already, and some
// do not. All that one change can concern is looked at again, and what comes out in the end does not depend on it.
#ifndef REPAIRS_GLSL
#define REPAIRS_GLSL

#include "grid.glsl"

BUFFER(SharedU32, uint, 4, coherent);

// A bit that was not set before.
bool takes_bit(SharedU32 bits, uint index) {
    uint bit = 1u << (index & 31u);
    return (atomicOr(bits.at[index >> 5], bit) & bit) == 0u;
}

// Whether a pixel has a neighbor of its own color, closer to the site; a site's own pixel counts as if it had.
bool keeps(SharedU32 colors, uint pixel, uint color, uint site, uvec2 size) {
    uvec3 key = key_of(pixel, site);
    bool found = pixel == site;
    [[unroll]] for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, size.x, size.y);
        uint other_color = colors.at[index_of(other == NONE ? pixel : other, size.x)];
        found = found || (other != NONE && other_color == color && before(key_of(other, site), key));
    }
    return found;
}

// Neighbor k of a pixel that has lost its color, if it has thereby become debris, else NONE. It loses its color too, and its
// index is to be listed.
uint new_debris(SharedU32 colors, ReadU32 sites, SharedU32 debris_bits, uint index, uint k, uvec2 size) {
    uint pixel = neighbor(pixel_at(index, size.x), k, size.x, size.y);
    uint there = index_of(pixel, size.x);
    uint color = pixel == NONE ? UNCOLORED : colors.at[there];
    if (color == UNCOLORED || keeps(colors, pixel, color, sites.at[color], size)) {
        return NONE;
    }
    if (!takes_bit(debris_bits, there)) {
        return NONE;
    }
    colors.at[there] = UNCOLORED;
    return there;
}

// The best color on offer: of the neighbors that are closer to their site than the pixel is, the one whose site comes first
// for the pixel.
uint best_color(SharedU32 colors, ReadU32 sites, uint pixel, uvec2 size) {
    uint color[8];
    uint site[8];
    [[unroll]] for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, size.x, size.y);
        uint found = colors.at[index_of(other == NONE ? pixel : other, size.x)];
        color[k] = other == NONE ? UNCOLORED : found;
    }
    [[unroll]] for (uint k = 0u; k < 8u; k++) {
        site[k] = sites.at[color[k] == UNCOLORED ? 0u : color[k]];
    }
    uvec3 best = uvec3(NONE);
    uint best_color = UNCOLORED;
    [[unroll]] for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, size.x, size.y);
        uvec3 key = key_of(pixel, site[k]);
        bool better = color[k] != UNCOLORED && before(key_of(other, site[k]), key) && before(key, best);
        best = better ? key : best;
        best_color = better ? color[k] : best_color;
    }
    return best_color;
}

// A pixel takes the best color on offer. Where that changes it the debris around it is to be listed: a bit for each neighbor.
uint recolor(SharedU32 colors, ReadU32 sites, SharedU32 debris_bits, SharedU32 listed_bits, uint index, uvec2 size) {
    uint pixel = pixel_at(index, size.x);
    uint color = best_color(colors, sites, pixel, size);
    uint listed = 0u;
    if (color != colors.at[index]) {
        colors.at[index] = color;
        uint words[8];
        [[unroll]] for (uint k = 0u; k < 8u; k++) {
            uint other = neighbor(pixel, k, size.x, size.y);
            words[k] = other == NONE ? 0u : debris_bits.at[index_of(other, size.x) >> 5];
        }
        [[unroll]] for (uint k = 0u; k < 8u; k++) {
            uint there = index_of(neighbor(pixel, k, size.x, size.y), size.x);
            if ((words[k] >> (there & 31u) & 1u) != 0u && takes_bit(listed_bits, there)) {
                listed |= 1u << k;
            }
        }
    }
    return listed;
}

#endif
