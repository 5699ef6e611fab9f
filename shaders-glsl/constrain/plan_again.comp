// Walks that go on after many steps are begun again in other pieces, if they run through many vertices. 1 of 3, by one workgroup:
// which constraints these may be, if there are few, and room for their pieces.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"

layout(push_constant, std430) uniform Args {
    U32 state;
    ReadU32 runs;
    U32x4 pieces;
    U32 piece_met;
    U32 piece_count;
    U32 words;
    uint constraints;
    uint piece_limit;
};

// Walks that are looked at, buckets along a constraint, and what is not worth it.
const uint MOST_WALKS = 4096u;
const uint MOST_BUCKETS = 16384u;
const uint LEAST_BUCKETS = 128u;

shared uint chosen[MOST_AGAIN];

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint waiting = words.at[WAITING];
    if (waiting == 0u || waiting > MOST_WALKS) {
        return;
    }
    if (rank < MOST_AGAIN) {
        chosen[rank] = NONE;
    }
    barrier();
    uint now = list_now(words, constraints + piece_limit);
    for (uint i = rank; i < waiting; i += WORKGROUP) {
        uint item = state.at[now + i];
        uint c = item < constraints ? item : pieces.at[item - constraints].x;
        for (uint slot = 0u; slot < MOST_AGAIN; slot++) {
            uint there = atomicCompSwap(chosen[slot], NONE, c);
            if (there == NONE || there == c) {
                break;
            }
        }
    }
    barrier();
    uint count = 0u;
    while (count < MOST_AGAIN && chosen[count] != NONE) {
        count++;
    }
    uint run = min(piece_count.at[0], piece_limit);
    uint room = piece_limit - run;
    uint buckets = room < count ? 0u : min((room - count) / count, MOST_BUCKETS);
    if (buckets < LEAST_BUCKETS) {
        return;
    }
    if (rank < count) {
        uint c = chosen[rank];
        uint pieces_of = runs.at[c] == NONE ? 1u : piece_count_of(pieces.at[runs.at[c]]);
        words.at[CHOSEN_LIST + rank] = c;
        words.at[CHOSEN_FOUND + rank] = 0u;
        words.at[CHOSEN_NEED + rank] = 64u + 2u * pieces_of;
    }
    // Superfluous as yet.
    for (uint k = rank; k < count * buckets; k += WORKGROUP) {
        pieces.at[run + k] = uvec4(chosen[k / buckets], (k % buckets + 1u) << 16 | (buckets + 1u), NO_PIECE, 0u);
        piece_met.at[run + k] = 0u;
    }
    uint more = count * (buckets + 1u);
    for (uint k = rank; k < more; k += WORKGROUP) {
        state.at[now + waiting + k] = NO_ITEM;
    }
    barrier();
    if (rank == 0u) {
        words.at[CHOSEN] = count;
        words.at[CHOSEN_RUN] = run;
        words.at[BUCKETS] = buckets;
        words.at[STOPS_BEFORE] = words.at[STOPS];
        piece_count.at[0] = run + count * buckets;
        words.at[WAITING] = waiting + more;
        uvec3 groups = groups_of(waiting + more);
        words.at[GROUPS] = groups.x;
        words.at[GROUPS + 1u] = groups.y;
        words.at[GROUPS + 2u] = groups.z;
    }
}
