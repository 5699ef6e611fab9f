// What the kernels of stage 3 share: the state of each site, the words that steer rounds, lists, walks around a vertex.
#ifndef SHIFT_GLSL
#define SHIFT_GLSL

layout(local_size_x_id = 0, local_size_x = 128) in;
#include "groups.glsl"
#include "mesh.glsl"
#include "append.glsl"

BUFFER(Points, uvec4, 16, );
BUFFER(ReadPositions, uvec4, 16, readonly);

// The state of a site that is not pinned is its number; of one that was taken out, its heir. The state of a pinned site
// has the highest bit, and
// - while sites are pinned: its place in the list of pinned sites;
// - while they are unpinned: that, then the neighbor that it waits for, and once it was tried the round of that and how it
//   ended;
// - while they are taken out: a half-edge that starts there.
const uint PINNED = 0x80000000u;
const uint TRIED = 0x40000000u;
const uint FREED = 0x20000000u;
const uint ROUND = 0x1fffffffu;
const uint PLACE = 0x3fffffffu;

// Rounds of a batch are counted in rows of words: entry k is what the kernels of round k work on.
const uint PIN_LEFT = 0u;       // fresh sites after the last round, or sites still to be tried
const uint OUT_LEFT = 4u;       // sites still to be taken out
const uint BROKEN = 8u;         // complement of the lowest vertex whose star is broken
const uint EMPTY = 12u;         // whether the mesh has become empty
const uint TAKEN = 16u;         // sites taken out
const uint PIN_BASE = 20u;      // sites pinned before this batch
const uint PIN_ROUNDS = 21u;
const uint UNPIN_BASE = 22u;    // rounds of unpinning before this batch
const uint UNPIN_ROUNDS = 23u;
const uint UNPIN_STARTED = 24u; // zero; the batch of the first round: 1; later: 2
const uint OUT_ROUNDS = 25u;
const uint CHAIN = 26u;         // the round of this batch that found no finite triangle, and one more
const uint BAD = 27u;           // sites pinned
const uint STUCK = 28u;         // those that were not freed
const uint PIN_COUNTS = 32u;    // sites pinned just before
const uint UNPIN_COUNTS = 96u;  // sites not tried yet
const uint OUT_COUNTS = 160u;   // pinned sites
const uint OUT_WINNERS = 192u;
const uint OUT_DEFERRED = 224u;
const uint OUT_EDGES = 256u;    // outer edges of the winners' stars
const uint OUT_SECOND = 288u;   // pinned sites that the first turn of a round did not elect

uint first_item() {
    return gl_WorkGroupID.x * WORKGROUP + gl_LocalInvocationIndex;
}

uint item_stride() {
    return gl_NumWorkGroups.x * WORKGROUP;
}

// How many sites were pinned before those of entry k.
uint pinned_before(U32 words, uint k) {
    uint sum = words.at[PIN_BASE];
    for (uint j = 0u; j < k; j++) {
        sum += words.at[PIN_COUNTS + j];
    }
    return sum;
}

// Pins a site; whether it was not pinned before. Its place is still to be written.
bool pin(U32 state, uint v) {
    return state.at[v] == v && atomicCompSwap(state.at[v], v, PINNED | PLACE) == v;
}

// Whether a pinned site was not tried before this round.
bool is_waiting(uint state, uint round) {
    return (state & PINNED) != 0u && ((state & TRIED) == 0u || (state & ROUND) == round);
}

// A walk around a vertex is a chain of reads, each of which waits for the one before. So a walk takes a few steps before it
// looks at what it has met, and all that it looks at comes at once. Rings of so many neighbors are kept for sites that were
// pinned.
const uint STEPS = 8u;

// No star of a mesh that a grid gives comes near this many triangles: more is a broken mesh.
const uint MOST_TRIANGLES_OF_STAR = 1u << 20;

void note_broken(U32 words, uint v) {
    atomicMax(words.at[BROKEN], ~v);
}

#endif
