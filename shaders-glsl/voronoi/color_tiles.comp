// Coloring, 1 of 8: a tile of pixels for each workgroup, each pixel by a search around it that is exact. A tile with a pixel,
// in it or next to it, that has no site nearer than RADIUS + 1 is left to the bands, and listed. All pixels without a closer
// neighbor of their color are marked as debris.
//
// 1. The bits of the sites in the tile and around it go to shared memory.
// 2. Each pixel of these rows finds the nearest site in its row, from 31 to the left to 31 to the right.
// 3. Each pixel of the tile, and those next to it, take the best of the rows around, as far as the best one so far is away.
// 4. The color is the number of bits before the site's. A pixel whose neighbor toward the site has the same site is no debris.
//
// Sites stand relative to pixels: (x + 32) << 6 | (y + 32), so that among sites equally far the lower word wins.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tiles.glsl"

layout(constant_id = 1) const uint RADIUS = 16u; // a multiple of 4, at most 28

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    ReadU32 ranks;
    WriteU32 colors;
    U32 debris_bits;
    WriteU32 any_debris;
    WriteU32 left;   // the tiles that are left to the bands
    U32 left_count;
    WriteU32 wanted; // whether there are any in each row of tiles
    uint width;
    uint height;
};

const uint COLUMNS = TILE_WIDTH + 2u;
const uint ROWS = TILE_HEIGHT + 2u;
const uint WORDS = 6u;
const uint NO_PIXEL = 0xffffu;

// Words of four rows each, for step 3: so many an invocation.
const uint FOURS = ROWS / 4u * COLUMNS;
const uint ITEMS = (FOURS + WORKGROUP - 1u) / WORKGROUP;
const uint IN_ROW = (ROWS / 4u + RADIUS / 2u) * COLUMNS;

shared uint site_bits[(ROWS + 2u * RADIUS) * WORDS];
// First what step 2 finds, four rows in a word: 32 + x, or 0 without a site. Then what step 3 finds, two rows in a word. How
// many workgroups run at once depends on how little memory they share.
shared uint found[IN_ROW > 2u * FOURS ? IN_ROW : 2u * FOURS];
shared uint uncertain;
shared uint any_site;

// In column c of the tile and one around, with those that are 31 to either side.
uint nearest_in_row(uint row, uint c) {
    uint place = 2u * 32u - 1u + c;
    uint word = row * WORDS + (place >> 5);
    uint bit = place & 31u;
    uint here = site_bits[word];
    uint to_left = here << (31u - bit) | site_bits[word - 1u] >> 1 >> bit;
    uint to_right = here >> bit | site_bits[word + 1u] << 1 << (31u - bit);
    uint by_left = 31u - uint(findMSB(to_left));
    uint by_right = min(uint(findLSB(to_right)), 32u);
    return by_left <= by_right ? 32u - by_left : (32u + by_right) & 63u;
}

// The best of four rows, from `dy` on, for each of four pixels below each other.
void improve(uint rows, int dy, inout uvec4 best) {
    [[unroll]] for (int i = 0; i < 4; i++) {
        uint column = rows >> 8 * i & 0xffu;
        int x = int(column) - 32;
        uint key = uint(x * x) << 12 | column << 6;
        [[unroll]] for (int j = 0; j < 4; j++) {
            int y = dy + i - j;
            best[j] = min(best[j], key + (uint(y * y) << 12 | uint(y + 32)));
        }
    }
}

// Whether the four pixels have found what no row further than `reach` can better.
bool found_all(uvec4 best, bvec4 asked, uint reach) {
    uint limit = (reach + 1u) * (reach + 1u) << 12;
    return all(lessThan(mix(uvec4(0u), best, asked), uvec4(limit)));
}

uint nearest_at(uint c, uint row) {
    return found[(row >> 1) * COLUMNS + c] >> 16u * (row & 1u) & 0xffffu;
}

// Whether a pixel has a neighbor with the same site, closer to it than it is.
bool has_closer(uint c, uint row, uint site) {
    ivec2 offset = ivec2(site >> 6, site & 63u) - 32;
    for (int k = 0; k < 9; k++) {
        ivec2 by = ivec2(k % 3, k / 3) - 1;
        ivec2 other = offset - by;
        int longer = offset.x * offset.x + offset.y * offset.y - other.x * other.x - other.y * other.y;
        bool lower = by.x < 0 || (by.x == 0 && by.y < 0);
        uint same_site = uint(other.x + 32) << 6 | uint(other.y + 32);
        bool same = nearest_at(uint(int(c) + by.x), uint(int(row) + by.y)) == same_site;
        if (same && (longer > 0 || (longer == 0 && lower))) {
            return true;
        }
    }
    return false;
}

void leave(uint tile, uint tile_row) {
    if (gl_LocalInvocationIndex == 0u) {
        left.at[atomicAdd(left_count.at[0], 1u)] = tile;
        wanted.at[tile_row] = 1u;
    }
}

void main() {
    uint tile = group_index();
    uint across = tiles_across(width);
    uint x0 = tile % across * TILE_WIDTH;
    uint tile_row = tile / across;
    uint y0 = tile_row * TILE_HEIGHT;
    if (y0 >= height) {
        return;
    }
    uint lane = gl_LocalInvocationIndex;
    uint pitch = pitch_of(width);

    // 1. From row y0 - 1 - RADIUS and word x0 / 32 - 2 on; what lies before the grid wraps around and is beyond its end.
    if (lane == 0u) {
        uncertain = 0u;
        any_site = 0u;
    }
    barrier();
    for (uint i = lane; i < (ROWS + 2u * RADIUS) * WORDS; i += WORKGROUP) {
        uint y = y0 + i / WORDS - 1u - RADIUS;
        uint word = x0 / 32u + i % WORDS - 2u;
        uint here = y < height && word < pitch ? bits.at[y * pitch + word] : 0u;
        site_bits[i] = here;
        if (here != 0u) {
            any_site = 1u;
        }
    }
    barrier();

    if (any_site == 0u) {
        leave(tile, tile_row);
        return;
    }

    // 2.
    for (uint i = lane; i < IN_ROW; i += WORKGROUP) {
        uint row = i / COLUMNS * 4u;
        uint c = i % COLUMNS;
        found[i] = nearest_in_row(row, c) | nearest_in_row(row + 1u, c) << 8 | nearest_in_row(row + 2u, c) << 16
            | nearest_in_row(row + 3u, c) << 24;
    }
    barrier();

    // 3.
    uvec2 kept[ITEMS];
    [[unroll]] for (uint item = 0u; item < ITEMS; item++) {
        uint i = min(lane + item * WORKGROUP, FOURS - 1u);
        uint c = i % COLUMNS;
        uint group = i / COLUMNS;
        uint y = y0 + group * 4u - 1u;
        bvec4 asked = lessThan(uvec4(y, y + 1u, y + 2u, y + 3u), uvec4(x0 + c - 1u < width ? height : 0u));
        uint at = i + RADIUS / 4u * COLUMNS;
        uvec4 best = uvec4(NONE);
        improve(found[at], 0, best);
        uint reach = 0u;
        if (RADIUS > 0u) {
            improve(found[at - COLUMNS], -4, best);
            improve(found[at + COLUMNS], 4, best);
            reach = 4u;
        }
        bool found_it = found_all(best, asked, reach);
        while (!found_it && reach < RADIUS) {
            reach += 4u;
            improve(found[at - reach / 4u * COLUMNS], -int(reach), best);
            improve(found[at + reach / 4u * COLUMNS], int(reach), best);
            found_it = found_all(best, asked, reach);
        }
        if (!found_it) {
            uncertain = 1u;
        }
        uvec4 site = mix(uvec4(NO_PIXEL), best & 0xfffu, asked);
        kept[item] = uvec2(site.x | site.y << 16, site.z | site.w << 16);
    }
    barrier();
    [[unroll]] for (uint item = 0u; item < ITEMS; item++) {
        uint i = min(lane + item * WORKGROUP, FOURS - 1u);
        uint at = i / COLUMNS * 2u * COLUMNS + i % COLUMNS;
        found[at] = kept[item].x;
        found[at + COLUMNS] = kept[item].y;
    }
    barrier();
    if (uncertain != 0u) {
        leave(tile, tile_row);
        return;
    }

    // 4.
    for (uint i = lane; i < TILE_WIDTH * TILE_HEIGHT; i += WORKGROUP) {
        uint c = i % TILE_WIDTH + 1u;
        uint row = i / TILE_WIDTH + 1u;
        uint x = x0 + c - 1u;
        uint y = y0 + row - 1u;
        if (x >= width || y >= height) {
            continue;
        }
        uint site = nearest_at(c, row);
        ivec2 offset = ivec2(site >> 6, site & 63u) - 32;
        uint place = uint(int(2u * 32u - 1u + c) + offset.x);
        uint word = site_bits[uint(int(row + RADIUS) + offset.y) * WORDS + (place >> 5)];
        uint rank = ranks.at[uint(int(y) + offset.y) * pitch + (uint(int(x) + offset.x) >> 5)];
        colors.at[y * width + x] = rank + uint(bitCount(word & below(place)));
        ivec2 toward = sign(offset);
        uint next = nearest_at(uint(int(c) + toward.x), uint(int(row) + toward.y));
        if (next != site - uint(toward.x * 64 + toward.y) && !has_closer(c, row, site)) {
            uint index = y * width + x;
            any_debris.at[0] = 1u;
            atomicOr(debris_bits.at[index >> 5], 1u << (index & 31u));
        }
    }
}
