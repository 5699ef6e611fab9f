// The pairs that may be flipped because a triangle of them got its owner in this outer round: they join those that are left
// from the inner rounds before. All triangles are looked at, so that pairs are listed in the order of triangles: those nearby
// are worked on together in all rounds after. Also sums up what pieces of walks crossed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "appending.glsl"
#include "candidates.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadPoints positions;
    ReadU32 owner;
    U32 state;
    ReadU32x4 pieces;
    ReadU32 piece_count;
    ReadU32 piece_walked;
    U32x2 pairs; // of even rounds, then of odd ones
    U32 words;
    uint stride;
    uint slots;
    uint piece_limit;
};

bool is_new(uint t, uint round) {
    return state.at[STAMP(t)] == (round << 2 | LISTED);
}

// The triangle after t along its owner, or before it; NONE if it has another owner.
uint beside(uint t, bool after) {
    uint word = owner.at[t];
    uint gate = after ? outward(word) : inward(word);
    if (gate == NO_EDGE) {
        return NONE;
    }
    uint x = twin(links, 3u * t + gate) / 3u;
    return same_owner(word, owner.at[x]) ? x : NONE;
}

void main() {
    uint round = words.at[ROUND];
    uint parity = round & 1u;
    bool fails = words.at[DEPART_FAULT] != NONE || words.at[WALK_FAULT] != NONE;
    uint end = fails || words.at[MARKED] == 0u ? 0u : slots;
    uint piece_end = end == 0u ? 0u : min(piece_count.at[0], piece_limit);
    for (uint p = item_index(); p < piece_end; p += item_stride()) {
        uvec4 piece = pieces.at[p];
        // What is behind the first piece that came to the end is superfluous.
        if (piece_number(piece) <= pieces.at[first_piece(piece, p)].w) {
            add_wide(words, WALKED, piece_walked.at[p]);
        }
    }
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        bool mine = i < end && owner.at[i] != FREE && is_new(i, round);
        uint t = mine ? i : NONE;
        uint some;
        sum_before(uint(mine), some);
        if (some == 0u) {
            continue;
        }
        // The triangle itself. The one before it, if that is older, cannot have been the first of a pair before. The one after
        // it, if that is older, can, but then in case 1; and if the one after that is new, it is looked at from there.
        [[dont_unroll]] for (uint turn = 0u; turn < 3u; turn++) {
            uint a = t;
            if (t != NONE && turn != 0u) {
                a = beside(t, turn == 2u);
                if (a != NONE && is_new(a, round)) {
                    a = NONE;
                }
                if (a != NONE && turn == 2u) {
                    uint c = beside(a, true);
                    a = c != NONE && is_new(c, round) ? NONE : a;
                }
            }
            Candidate found = NO_PAIR;
            if (a != NONE) {
                found = candidate(U32(triangles), U32(links), positions, U32(owner), state, stride, NONE, a);
                if (turn == 2u && found.entry.y >> CLAIM_BITS == 0u) {
                    found = NO_PAIR;
                }
            }
            uint place = place_in(words, CANDIDATES + parity, found.a != NONE);
            if (found.a != NONE) {
                claim(state, stride, parity, found);
                pairs.at[parity * stride + place] = found.entry;
            }
        }
    }
}
