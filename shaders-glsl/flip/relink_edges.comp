// Step 3 of a round, second half: renews the links around all flips, and gives claimed triangles back. The edges of a next
// round are nobody's concern.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"

layout(push_constant, std430) uniform Args {
    Rows links;
    U32 state;
    ReadU32 illegal;
    U32 words;
    uint stride;
    uint parity;
};

void main() {
    uint end = 4u * words.at[TAKEN_COUNT];
    uint round = words.at[ROUND_NOW];
    if (item_index() == 0u) {
        words.at[ILLEGAL_COUNT(parity)] = 0u;
        words.at[ROUND] = round;
    }
    for (uint i = item_index(); i < end; i += item_stride()) {
        uint h = illegal.at[i >> 2];
        uint k = i & 3u;
        if ((h & WON) != 0u) {
            h &= HALF_EDGE;
            uint g = prev_edge(link_of(links, next_edge(h)));
            if (k < 2u) {
                state.at[CLAIM(k == 0u ? h : g, parity)] = NONE;
            }
            renew(links, state, stride, round, side_of(h, g, k));
        } else if (k == 0u) {
            leave(links, state, stride, parity, round, h);
        }
    }
}
