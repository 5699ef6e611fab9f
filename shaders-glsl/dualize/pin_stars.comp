// Pin: puts the sites that were pinned in the last round on their pixel centers, and tests the triangles around them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"
#include "center.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    Points positions;
    U32 state;
    U32 pinned;
    U32 words;
    ReadU32 pixels; // of sites
    WriteU32 rings; // STEPS words for each place: the neighbors in order
    int64_t translation_x;
    int64_t translation_y;
    int exponent_x;
    int exponent_y;
    uint half_side_x;
    uint half_side_y;
    uint ring_limit; // places that there is room for
    uint round;
};

uint first;
uint last;

bool is_fresh(uint word) {
    uint place = word ^ PINNED;
    return place >= first && place < last;
}

uvec4 center(uint v) {
    Grid grid;
    grid.translation = i64vec2(translation_x, translation_y);
    grid.exponents = ivec2(exponent_x, exponent_y);
    grid.half_sides = uvec2(half_side_x, half_side_y);
    return center_of(pixels.at[v], grid);
}

void pin_corner(uint v, uint spoke) {
    if (pin(state, v)) {
        uint place = last + append(words, PIN_COUNTS + round + 1u);
        pinned.at[place] = spoke;
        state.at[v] = PINNED | place;
    }
}

void main() {
    first = pinned_before(words, round);
    last = first + words.at[PIN_COUNTS + round];
    for (uint i = first + first_item(); i < last; i += item_stride()) {
        uint start = pinned.at[i];
        uint v = origin(triangles, start);
        uint u = destination(triangles, start);
        uvec4 at = center(v);
        positions.at[v] = at;
        bool fresh_u = u < DELETED && is_fresh(state.at[u]);
        uvec4 at_u = u >= DELETED ? at : fresh_u ? center(u) : positions.at[u];
        uint h = start;
        uint steps = 0u;
        bool closed = false;
        while (!closed && steps < MOST_TRIANGLES_OF_STAR) {
            uint spokes[STEPS];
            uint ends[STEPS]; // of the next spoke
            bool fresh[STEPS];
            uvec4 where[STEPS];
            uint count = 0u;
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                spokes[k] = h;
                ends[k] = apex(triangles, h);
                if (!closed) {
                    count++;
                    h = rotate_ccw(links, h);
                    closed = h == start;
                }
            }
            if (steps == 0u && i < ring_limit) {
                // A larger star has no ring.
                [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                    rings.at[STEPS * i + k] = closed && k < count ? ends[k] : DELETED;
                }
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                uint w = ends[k] < DELETED ? ends[k] : v;
                where[k] = positions.at[w];
                fresh[k] = is_fresh(state.at[w]);
            }
            [[dont_unroll]] for (uint k = 0u; k < count; k++) {
                uint w = ends[k];
                uvec4 at_w = where[k];
                if (fresh[k] && w < DELETED) {
                    at_w = center(w);
                }
                // A triangle is tested from its lowest fresh corner.
                bool elsewhere = fresh_u && u < v || fresh[k] && w < v;
                if (max(u, w) < DELETED && !elsewhere) {
                    if (orient2d(at, at_u, at_w) != 1) {
                        pin_corner(u, next_edge(spokes[k]));
                        pin_corner(w, prev_edge(spokes[k]));
                    }
                }
                u = w;
                at_u = at_w;
                fresh_u = fresh[k];
            }
            steps += STEPS;
        }
        if (!closed) {
            note_broken(words, v);
        }
    }
}
