// What the kernels of the walk share.
//
// *Items* are the constraints, and behind them the later pieces of long ones. An item that has not come to its end in one
// dispatch goes on in the next. For each item there is a word, the half-edge at which it stands, with CROSSES if it is about
// to cross it; behind these lie two lists of items, of which a round reads one and writes the other.
#ifndef WALK_GLSL
#define WALK_GLSL

#include "invocations.glsl"
#include "mesh.glsl"
#include "pieces.glsl"

BUFFER(U32x2, uvec2, 8, );
BUFFER(WriteU32x2, uvec2, 8, writeonly);

const uint CROSSES = 0x80000000u;

// For each constraint how many vertices its first piece met, with REVERSED if it began at the second end, and with AGAIN if it
// was begun again in other pieces: see `plan_again`.
const uint REVERSED = 0x80000000u;
const uint AGAIN = 0x40000000u;
const uint MET = 0x3fffffffu;
// In a list, in place of an item that does not go on.
const uint NO_ITEM = 0xffffffffu;

// The words that steer. Items that go on, those of the next round (before the first, the constraints that walk), and which
// list holds the former.
const uint WAITING = 0u;
const uint NEXT = 24u;
const uint PARITY = 2u;
const uint ROUND = 3u;
// Workgroups for them.
const uint GROUPS = 4u;
// Constraints in the first list; behind them come all later pieces.
const uint WALKERS = 7u;
// Vertices met, also those for which there was no room.
const uint STOPS = 8u;
// The lowest constraint whose walk was lost; NONE before.
const uint LOST_WALK = 12u;
// Sub-constraints, and vertices in all chains.
const uint SUB_CONSTRAINTS = 16u;
const uint CHAINED = 20u;

// Constraints that may be begun again: how many, which, how many buckets along each have a vertex, and how many must.
const uint MOST_AGAIN = 32u;
const uint CHOSEN = 25u;
const uint CHOSEN_LIST = 28u;
const uint CHOSEN_FOUND = 60u;
const uint CHOSEN_NEED = 92u;
// Where the pieces of the first of them begin, buckets of each, vertices met by then.
const uint CHOSEN_RUN = 124u;
const uint BUCKETS = 125u;
const uint STOPS_BEFORE = 126u;

// No list is to grow so long that its count wraps around.
const uint MOST_STOPS = 0xf0000000u;

// Where the list of this round begins, and that of the next.
uint list_now(U32 words, uint items) {
    return items * (1u + words.at[PARITY]);
}

uint list_next(U32 words, uint items) {
    return items * (2u - words.at[PARITY]);
}

#endif
