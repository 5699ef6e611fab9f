// Insertion of sub-constraints: what steers it, whose a triangle is, and flips of pairs. Kernels that see what other
// invocations of the same dispatch wrote define COHERENT.
#ifndef INSERT_GLSL
#define INSERT_GLSL

#include "invocations.glsl"
#include "mesh.glsl"
#include "pieces.glsl"

BUFFER(SharedU32, uint, 4, coherent);
BUFFER(U32x2, uvec2, 8, );
BUFFER(SharedU32x2, uvec2, 8, coherent);

#ifdef COHERENT
#define WORDS SharedU32
#define MESH SharedRows
#define FOUR_WORDS SharedFourWords
#define PAIRS SharedU32x2
#else
#define WORDS U32
#define MESH Rows
#define FOUR_WORDS FourWords
#define PAIRS U32x2
#endif
#include "tallies.glsl"
// Those that kernels have as arguments, of even and of odd rounds.
#define pairs_of(PARITY) ((PARITY) == 0u ? even_pairs : odd_pairs)

// The words that steer rounds.
// Sub-constraints that are not in yet; zero also where nothing can go on.
const uint LEFT = 0u;
// Sub-constraints that are edges.
const uint INSERTED = 1u;
// The number of the outer round.
const uint OUTER = 2u;
// Whether the inner rounds of this outer round go on: then nobody departs.
const uint GOES_ON = 3u;
// How many inner rounds this outer round has; NONE if they go on to the end.
const uint INNER_LIMIT = 4u;
// Whether a round changed nothing.
const uint STUCK = 5u;
// Whether any walker of this outer round goes by flips.
const uint MARKED = 6u;
// Walkers of this outer round.
const uint WALKERS = 7u;
// Those of them that do walk, in a list of their own: who leaves a hub may have to wait.
const uint ADMITTED = 8u;
// Sub-constraints that walked, or had to wait, in this outer round and do not own their whole chain; and those of the round before.
const uint LOSERS = 9u;
const uint WAITED = 10u;
// Pairs that may be flipped in even and in odd inner rounds.
const uint CANDIDATES = 12u;
// Pairs that this inner round takes.
const uint TAKEN = 14u;
// The number of the last inner round, which never repeats; and of this one.
const uint ROUND = 15u;
const uint ROUND_NOW = 16u;
// Inner rounds of this outer round.
const uint INNER = 17u;
// What the turn before has seen of flips and insertions.
const uint PROGRESS = 18u;
// What had been walked before this outer round, in two words.
const uint WALKED_BEFORE = 34u;
// Whether there are hubs; and whether, since there are, any triangle has got another owner in this outer round.
const uint HUBS = 21u;
const uint STOLEN = 11u;
// Pairs that are left from the rounds before the walks, which stand first in their list, and the last of these rounds.
const uint HELD = 19u;
const uint HELD_ROUND = 38u;
// Walks from hubs that were not whole.
const uint PARTIAL_WALKS = 41u;
// What is reported; sums have two words, the low one first.
const uint EDGES_ALREADY = 20u;
const uint REBUILT = 39u;
// The triangles of the longest chain that is rebuilt.
const uint LONGEST = 40u;
const uint INTERSECTIONS = 22u;
const uint WALKED = 24u;
const uint OUTER_ROUNDS = 26u;
const uint INNER_ROUNDS = 27u;
const uint FLIPS = 28u; // by case
// The least sub-constraint that cannot go on, four times its number and why: on leaving its vertex, and on its way.
const uint DEPART_FAULT = 36u;
const uint WALK_FAULT = 37u;

// Why a sub-constraint cannot go on.
const uint BLOCKED = 0u;
const uint THROUGH_VERTEX = 1u;
const uint ASTRAY = 2u;

// What there is to know of a sub-constraint, in `lost`: whether it does not own its whole chain, whether it begins at a hub,
// whether it does not walk in this round, since it has to wait there or is an edge, and whether it goes by flips, as all do that
// begin at hubs; above, once it walks, the triangle at its lower end. Or DONE, if it has become an edge and did not go by flips,
// from the outer round after on. And in `firsts`: the half-edge that it crosses first, with REVERSED if it begins at its second
// end; NONE if it is in.
const uint LOSES = 1u;
const uint AT_HUB = 2u;
const uint BARRED = 4u;
const uint LONG = 8u;
const uint BY_FLIPS = AT_HUB | LONG;
#define LOW_SHIFT 4
// Those that begin at a hub have a count of their walks there instead.
const uint WALKED_ONCE = 16u;
const uint DONE = 0xfffffff0u;
const uint REVERSED = 0x80000000u;

// The word of a triangle that nobody owns, and no edge in the word of one that somebody does: `place` of the reference.
const uint FREE = 0xffffffffu;
const uint NO_EDGE = 3u;

const uint OWNER_BITS = 28u;
const uint CLAIM_BITS = 30u;
// No third triangle in the second word of a candidate, and the bits of one; the case, less one, is above.
const uint NO_B = 0x3fffffffu;
// The mark of a candidate that was flipped.
const uint WON = 0x80000000u;
// Instead of an edge in a stamp: listed, not flipped.
const uint LISTED = 3u;

// State is four words a triangle, all NONE at first: the least key that claims it, in even and in odd rounds, else NONE; its
// stamp, four times the last round that flipped or listed it, plus the edge along which it was flipped, or LISTED, all
// inverted; and whose it is. What one that is DONE owned stays its own until another one claims it.
#define CLAIM(T, PARITY) (4u * (T) + (PARITY))
#define STAMP(T) (4u * (T) + 2u)
#define OWNED(T) (4u * (T) + 3u)
#define stamp_of(STATE, T) (~STATE.at[STAMP(T)])

bool has_failed(WORDS words) {
    return words.at[DEPART_FAULT] != NONE || words.at[WALK_FAULT] != NONE;
}

uint scatter(uint id, uint bits) {
    uint mask = (1u << bits) - 1u;
    uint x = id;
    x ^= x >> (bits / 2u);
    x = (x * 0x7feb352du) & mask;
    x ^= x >> (bits / 2u - 1u);
    x = (x * 0x846ca68bu) & mask;
    return x ^ (x >> (bits / 2u));
}

// The sub-constraint of an owner's priority.
uint owner_of(uint word) {
    uint mask = (1u << OWNER_BITS) - 1u;
    uint x = word >> 4;
    x ^= x >> 14;
    x = (x * 0x43021123u) & mask;
    x ^= x >> 13 ^ x >> 26;
    x = (x * 0x1d69e2a5u) & mask;
    return x ^ (x >> 14);
}

bool same_owner(uint a, uint b) {
    return a != FREE && b != FREE && (a ^ b) < 16u;
}

uint inward(uint word) {
    return word & 3u;
}

uint outward(uint word) {
    return word >> 2 & 3u;
}

// The side of the corners opposite the edges where the owner comes in and goes out.
int side_of(uint word) {
    uint i = inward(word);
    uint o = outward(word);
    return i == NO_EDGE || o == NO_EDGE ? 0 : o == turned(i, 1u) ? 1 : -1;
}

#endif
