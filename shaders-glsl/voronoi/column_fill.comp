// Coloring, 4 of 8: for each pixel the row of the nearest site in its column, the lower one of two; one invocation for two
// columns of each band of rows, if a tile is left in them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "columns.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    ReadU32 ends;
    ReadU32 wanted;
    U32 nearest;
    uint width;
    uint height;
    uint band; // rows
};

void main() {
    uint item = item_index();
    uint pairs = pairs_of(width);
    uint pitch = pitch_of(width);
    uint x = item % pairs * 2u;
    uint number = item / pairs;
    uint from = number * band;
    if (from >= height) {
        return;
    }
    uint to = min(from + band, height);
    if (!wanted_rows(wanted, from, to)) {
        return;
    }
    uint bands = (height + band - 1u) / band;
    // The last site of the bands below, the first of those above.
    uvec2 below_it = uvec2(NO_ROW);
    uvec2 above = uvec2(NO_ROW);
    for (uint k = 0u; k < 2u && x + k < width; k++) {
        for (uint b = number; b > 0u && below_it[k] == NO_ROW; b--) {
            below_it[k] = ends.at[(b - 1u) * width + x + k] >> 16;
        }
        for (uint b = number + 1u; b < bands && above[k] == NO_ROW; b++) {
            above[k] = ends.at[b * width + x + k] & 0xffffu;
        }
    }
    for (uint y = from; y < to; y++) {
        uint two = bits.at[y * pitch + (x >> 5)] >> (x & 31u);
        below_it = mix(below_it, uvec2(y), notEqual(uvec2(two) & uvec2(1u, 2u), uvec2(0u)));
        nearest.at[y * pairs + x / 2u] = below_it.x | below_it.y << 16;
    }
    for (uint y = to; y > from;) {
        y--;
        uint two = nearest.at[y * pairs + x / 2u];
        below_it = uvec2(two & 0xffffu, two >> 16);
        bvec2 site = equal(below_it, uvec2(y));
        above = mix(above, uvec2(y), site);
        // Without a site above, or with one here, or with a nearer one below.
        for (uint k = 0u; k < 2u; k++) {
            if (above[k] != NO_ROW && (below_it[k] == NO_ROW || above[k] - y < y - below_it[k])) {
                below_it[k] = above[k];
            }
        }
        uint now = below_it.x | below_it.y << 16;
        if (now != two) {
            nearest.at[y * pairs + x / 2u] = now;
        }
    }
}
