// Pin: puts the sites that were pinned in the last round on their pixel centers, and tests the triangles around them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"
#include "center.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    Points positions;
    U32 state;
    U32 pinned;
    U32 deferred;
    U32 words;
    ReadU32 pixels; // of sites
    int64_t translation_x;
    int64_t translation_y;
    int exponent;
    uint half_side;
    uint round;
};

uint first;
uint last;

bool is_fresh(uint v) {
    uint place = state.at[v] ^ PINNED;
    return place >= first && place < last;
}

uvec4 center(uint v) {
    return center_of(pixels.at[v], translation_x, translation_y, exponent, half_side);
}

uvec4 position(uint v, bool fresh) {
    return fresh ? center(v) : positions.at[v];
}

void test(uint h, uint v, uvec4 at) {
    uint u = destination(triangles, h);
    uint w = apex(triangles, h);
    if (max(u, w) >= DELETED) {
        return;
    }
    bool fresh_u = is_fresh(u);
    bool fresh_w = is_fresh(w);
    // A triangle is tested from its lowest fresh corner.
    if (fresh_u && u < v || fresh_w && w < v) {
        return;
    }
    int sign = orient2d(at, position(u, fresh_u), position(w, fresh_w));
    if (sign == 1) {
        return;
    }
    if (sign == UNDECIDED) {
        deferred.at[append(words, PIN_DEFERRED + round + 1u)] = h / 3u;
        return;
    }
    for (uint k = 0u; k < 2u; k++) {
        uint corner = k == 0u ? u : w;
        uint spoke = k == 0u ? next_edge(h) : prev_edge(h);
        if (pin(state, corner)) {
            uint place = last + append(words, PIN_COUNTS + round + 1u);
            pinned.at[place] = spoke;
            state.at[corner] = PINNED | place;
        }
    }
}

void main() {
    first = pinned_before(words, round);
    last = first + words.at[PIN_COUNTS + round];
    for (uint i = first + first_item(); i < last; i += item_stride()) {
        uint start = pinned.at[i];
        uint v = origin(triangles, start);
        uvec4 at = center(v);
        positions.at[v] = at;
        uint h = start;
        uint steps = 0u;
        do {
            test(h, v, at);
            h = rotate_ccw(links, h);
            steps++;
        } while (h != start && steps < MOST_TRIANGLES_OF_STAR);
        if (h != start) {
            note_broken(words, v);
        }
    }
}
