// From one round of walks to the next; before the first, to the constraints that are no edges and all later pieces.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"

layout(push_constant, std430) uniform Args {
    U32 words;
    ReadU32 piece_count;
    uint piece_limit;
    uint begins;
};

void main() {
    if (item_index() != 0u) {
        return;
    }
    uint waiting = words.at[NEXT];
    if (begins != 0u) {
        words.at[WALKERS] = waiting;
        waiting += min(piece_count.at[0], piece_limit);
        words.at[ROUND] = 0u;
        words.at[PARITY] = 0u;
    } else {
        words.at[ROUND] += 1u;
        words.at[PARITY] ^= 1u;
    }
    words.at[WAITING] = waiting;
    words.at[NEXT] = 0u;
    uvec3 groups = groups_of(waiting);
    words.at[GROUPS] = groups.x;
    words.at[GROUPS + 1u] = groups.y;
    words.at[GROUPS + 2u] = groups.z;
}
