// Step 3 of a round, second half, and step 4: renews the links around all flips, gives claimed triangles back, and lists the
// edges of the next round: those around flips, and illegal ones next to no flip. No edge is listed twice.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "appending.glsl"

layout(push_constant, std430) uniform Args {
    U32 links;
    U32 state;
    ReadU32 illegal;
    WriteU32 edges;
    U32 edge_count;
    U32 words;
    uint stride;
    uint limit; // edges that the list takes
    uint parity;
};

void main() {
    uint end = 4u * words.at[TAKEN_COUNT];
    uint round = words.at[ROUND_NOW];
    if (item_index() == 0u) {
        words.at[ILLEGAL_COUNT(parity)] = 0u;
        words.at[ROUND] = round;
    }
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        Handed handed;
        handed.some = false;
        if (i < end) {
            uint h = illegal.at[i >> 2];
            uint k = i & 3u;
            if ((h & WON) != 0u) {
                h &= HALF_EDGE;
                uint g = prev_edge(links.at[next_edge(h)]);
                if (k < 2u) {
                    state.at[CLAIM(k == 0u ? h : g, parity)] = NONE;
                }
                handed = renew(links, state, stride, round, side_of(h, g, k));
            } else if (k == 0u) {
                handed = leave(links, state, stride, parity, round, h);
            }
        }
        uint place = place_in(edge_count, 0u, handed.some);
        if (handed.some && place < limit) {
            edges.at[place] = min(handed.side, handed.outer);
        }
    }
}
