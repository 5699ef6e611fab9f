// The pairs that may be flipped because a triangle of them got an owner that goes by flips in this outer round: they join those that
// are left from the inner rounds before. All triangles are looked at, so that pairs are listed in the order of triangles: those nearby
// are worked on together in all rounds after.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "appending.glsl"
#include "candidates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    U32 state;
    ReadU32 lost;
    U32x2 even_pairs;
    U32x2 odd_pairs;
    U32 words;
    uint slots;
};

// Triangles that a workgroup takes at once, and those of them that got their owner.
const uint BLOCK = 2048u;
shared uint new_ones[BLOCK];
shared uint new_count;

bool is_new(uint t, uint round) {
    return stamp_of(state, t) == (round << 2 | LISTED);
}

// The triangle after t along its owner, or before it; NONE if it has another owner.
uint beside(uint t, bool after) {
    uint word = state.at[OWNED(t)];
    uint gate = after ? outward(word) : inward(word);
    if (gate == NO_EDGE) {
        return NONE;
    }
    uint x = twin(links, 3u * t + gate) / 3u;
    return same_owner(word, state.at[OWNED(x)]) ? x : NONE;
}

void main() {
    uint round = words.at[ROUND];
    uint parity = round & 1u;
    bool fails = has_failed(words);
    uint end = fails || words.at[MARKED] == 0u ? 0u : slots;
    // Before the first round nothing was owned.
    uint turns = words.at[OUTER] == 0u ? 1u : 3u;
    uint rank = gl_LocalInvocationIndex;
    for (uint begin = group_index() * BLOCK; begin < end; begin += gl_NumWorkGroups.x * gl_NumWorkGroups.y * BLOCK) {
        barrier();
        if (rank == 0u) {
            new_count = 0u;
        }
        barrier();
        // All reads at once: stamps and words of owners.
        uvec2 both[BLOCK / WORKGROUP];
        [[unroll]] for (uint k = 0u; k < BLOCK / WORKGROUP; k++) {
            uint i = begin + rank + k * WORKGROUP;
            both[k] = i < end ? U32x2(state).at[2u * i + 1u] : uvec2(NONE);
        }
        [[unroll]] for (uint k = 0u; k < BLOCK / WORKGROUP; k++) {
            if (both[k].y != FREE && ~both[k].x == (round << 2 | LISTED) && (lost.at[owner_of(both[k].y)] & BY_FLIPS) != 0u) {
                new_ones[atomicAdd(new_count, 1u)] = begin + rank + k * WORKGROUP;
            }
        }
        barrier();
        uint count = new_count;
        for (uint from = 0u; from < count; from += WORKGROUP) {
            uint t = from + rank < count ? new_ones[from + rank] : NONE;
            // The triangle itself. The one before it, if that is older, cannot have been the first of a pair before. The one
            // after it, if that is older, can, but then in case 1; and if the one after that is new, it is looked at from
            // there.
            [[dont_unroll]] for (uint turn = 0u; turn < turns; turn++) {
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
                    found = candidate(Rows(triangles), Rows(links), positions, state, NONE, a);
                    if (turn == 2u && found.entry.y >> CLAIM_BITS == 0u) {
                        found = NO_PAIR;
                    }
                }
                uint place = place_in(words, CANDIDATES + parity, found.a != NONE);
                if (found.a != NONE) {
                    claim(state, parity, found);
                    pairs_of(parity).at[place] = found.entry;
                }
            }
        }
    }
}
