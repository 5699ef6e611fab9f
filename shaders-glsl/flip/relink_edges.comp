// Step 3 of a round, second half: renews the links around all flips, and gives claimed triangles back. The edges of a next
// round are nobody's concern.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"

layout(push_constant, std430) uniform Args {
    Rows links;
    ReadU32x2 illegal;
    U32 words;
    MaybeU32 note; // takes the number of edges tested in this round, and how many of them were illegal
    uint parity;
};

void main() {
    uint end = 4u * words.at[TAKEN_COUNT];
    uint round = words.at[ROUND_NOW];
    if (item_index() == 0u) {
        words.at[ILLEGAL_COUNT(parity)] = 0u;
        words.at[ROUND] = round;
        if (present(note)) {
            note.at[0] = words.at[LISTED_COUNT];
            note.at[1] = words.at[TAKEN_COUNT];
        }
    }
    for (uint i = item_index(); i < end; i += item_stride()) {
        uvec2 edge = illegal.at[i >> 2];
        if ((edge.x & WON) != 0u) {
            renew(links, look_out(links, round, side_of(uvec2(edge.x & HALF_EDGE, edge.y), i & 3u)));
        }
    }
}
