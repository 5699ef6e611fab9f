// The end of an inner round and the beginning of the next in one: renews the links around all flips, gives claimed triangles
// back, and looks at the triangles around flips, which claim what they need for the next round.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "appending.glsl"
#include "candidates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadPoints positions;
    U32 state;
    U32x2 even_pairs;
    U32x2 odd_pairs;
    U32 words;
};

void main() {
    uint taken = words.at[TAKEN];
    uint round = words.at[ROUND_NOW];
    uint parity = round & 1u ^ 1u;
    uint end = 4u * taken;
    if (item_index() == 0u && taken != 0u) {
        words.at[ROUND] = round;
        words.at[CANDIDATES + parity] = 0u;
        words.at[INNER] += 1u;
        words.at[INNER_ROUNDS] += 1u;
    }
    uint held = held_pairs(words, round);
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        Candidate found = NO_PAIR;
        if (i < end) {
            uvec2 entry = pairs_of(parity).at[(i >> 2)];
            Look look = settle(links, state, parity, round, entry, i & 3u);
            if (i >> 2 >= held) {
                found = look.known;
            }
            if (look.a != NONE && found.a == NONE) {
                found = candidate(Rows(triangles), links, positions, state, round, look.a);
            }
            renew(links, look);
        }
        uint place = place_in(words, CANDIDATES + (parity ^ 1u), found.a != NONE);
        if (found.a != NONE) {
            claim(state, parity ^ 1u, found);
            pairs_of(parity ^ 1u).at[place] = found.entry;
        }
    }
}
