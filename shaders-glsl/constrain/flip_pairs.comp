// Step 3 of an inner round, first half: pairs that have all they claimed are flipped. Outer links keep the names that they had
// before the round, until they are renewed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "pairs.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    U32 state;
    U32x2 even_pairs;
    U32x2 odd_pairs;
    U32 spokes;
    U32 degrees;
    U32 words;
    uint least; // fewer pairs are left to another kernel
};

shared uint flips_of_group[4]; // by case, and those that made an edge of their owner

void main() {
    uint round = words.at[ROUND] + 1u;
    uint parity = words.at[ROUND] & 1u;
    uint count = words.at[CANDIDATES + parity];
    bool fails = has_failed(words);
    bool goes_on = words.at[GOES_ON] == 0u || words.at[INNER] < words.at[INNER_LIMIT];
    uint end = count >= least && goes_on && !fails ? count : 0u;
    if (gl_LocalInvocationIndex < 4u) {
        flips_of_group[gl_LocalInvocationIndex] = 0u;
    }
    barrier();
    uint held = held_pairs(words, round);
    for (uint i = item_index(); i < end; i += item_stride()) {
        uvec2 entry = pairs_of(parity).at[i];
        if (wins(links, state, parity, entry, i < held ? round - 1u : NONE)) {
            uint done = flip_pair(triangles, links, state, spokes, degrees, words, round, entry.x);
            if (done == INSERTS) {
                atomicAdd(flips_of_group[3], 1u);
            }
            if (done != IS_BLOCKED) {
                pairs_of(parity).at[i].x = entry.x | WON;
                atomicAdd(flips_of_group[entry.y >> CLAIM_BITS], 1u);
            }
        }
    }
    barrier();
    uint rank = gl_LocalInvocationIndex;
    if (rank < 4u && flips_of_group[rank] != 0u) {
        if (rank == 3u) {
            atomicAdd(words.at[INSERTED], flips_of_group[rank]);
        } else {
            add_wide(words, FLIPS + 2u * rank, flips_of_group[rank]);
        }
    }
    if (item_index() == 0u) {
        words.at[TAKEN] = end;
        words.at[ROUND_NOW] = round;
    }
}
