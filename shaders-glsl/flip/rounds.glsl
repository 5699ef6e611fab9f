// What a round is made of. Kernels that see what other invocations of the same dispatch wrote define COHERENT.
#ifndef ROUNDS_GLSL
#define ROUNDS_GLSL

#include "invocations.glsl"
#include "mesh.glsl"

BUFFER(SharedU32, uint, 4, coherent);
BUFFER(MaybeU32, uint, 4, );
BUFFER(U32x2, uvec2, 8, );
BUFFER(ReadU32x2, uvec2, 8, readonly);
BUFFER(WriteU32x2, uvec2, 8, writeonly);
BUFFER(SharedU32x2, uvec2, 8, coherent);

#ifdef COHERENT
#define WORDS SharedU32
#define MESH SharedRows
#define FOUR_WORDS SharedFourWords
#else
#define WORDS U32
#define MESH Rows
#define FOUR_WORDS FourWords
#endif
#include "tallies.glsl"

// The words that steer rounds. Illegal edges, of even and of odd rounds: at 4 times the parity.
#define ILLEGAL_COUNT(PARITY) (4u * (PARITY))
// Illegal edges that this round takes: all, or none where it is another kernel's turn.
const uint TAKEN_COUNT = 8u;
// The number of the last round, which never repeats while the state is kept; and of this one.
const uint ROUND = 9u;
const uint ROUND_NOW = 10u;
// Whether any edge of the mesh was tested.
const uint ANY_TESTED = 11u;
// Edges of the list that was tested.
const uint LISTED_COUNT = 12u;
// Illegal edges after the tail.
const uint PENDING_COUNT = 16u;

// The words of a report; flips and tests take two.
const uint REPORT_ROUNDS = 0u;
const uint REPORT_FLIPS = 1u;
const uint REPORT_TESTS = 3u;

// Which edges may be flipped: all, or those at the ghost vertex alone.
const uint SCOPE_ALL = 0u;
const uint SCOPE_HULL = 1u;

// The mark of an illegal edge that was flipped.
const uint WON = 0x80000000u;

// By triangle the least priority that claims it, else NONE: who gets a triangle gives it back in the same dispatch. Not behind
// its corners, where atomics hold up those that read.
#define CLAIM(T) claims.at[T]
// Behind the links of a triangle stands its stamp: four times the last round that flipped it, plus the edge along which it was.
#define STAMP(T) note_of(links, T)

// Lists of illegal edges have both half-edges of each, the lower one first.

// Step 2: an illegal edge claims its two triangles, in the name of its lower half-edge.
void claim(WORDS claims, uint lower, uint upper) {
    uint mine = priority(lower);
    atomicMin(CLAIM(lower / 3u), mine);
    atomicMin(CLAIM(upper / 3u), mine);
}

// Step 3, first half: flips an edge if it has both its triangles; then nobody else touches their links. Outer links keep the
// names that they had before the round. Whether it was flipped.
bool flip_pair(MESH triangles, MESH links, WORDS claims, uint round, uvec2 edge) {
    uint mine = priority(edge.x);
    uint t = edge.x / 3u;
    uint u = edge.y / 3u;
    bool has_t = CLAIM(t) == mine;
    bool has_u = CLAIM(u) == mine;
    // All others find neither this claim nor their own.
    if (has_t) {
        CLAIM(t) = NONE;
    }
    if (has_u) {
        CLAIM(u) = NONE;
    }
    if (!has_t || !has_u) {
        return false;
    }
    uvec4 corners_t = FOUR_WORDS(triangles)[2u * t].row;
    uvec4 corners_u = FOUR_WORDS(triangles)[2u * u].row;
    uint k = edge.x - 3u * t;
    uint j = edge.y - 3u * u;
    uvec4 links_t = FOUR_WORDS(links)[2u * t].row;
    uvec4 links_u = FOUR_WORDS(links)[2u * u].row;
    uint k1 = turned(k, 1u);
    uint j1 = turned(j, 1u);
    uint t_outer = pick(links_t, k1);
    uint u_outer = pick(links_u, j1);
    uvec4 new_t = replaced(corners_t, turned(k, 2u), pick(corners_u, j));
    uvec4 new_u = replaced(corners_u, turned(j, 2u), pick(corners_t, k));
    FOUR_WORDS(triangles)[2u * t].row = uvec4(new_t.xyz, NONE);
    FOUR_WORDS(triangles)[2u * u].row = uvec4(new_u.xyz, NONE);
    links_t = replaced(replaced(links_t, k, u_outer), k1, 3u * u + j1);
    links_u = replaced(replaced(links_u, j, t_outer), j1, 3u * t + k1);
    FOUR_WORDS(links)[2u * t].row = uvec4(links_t.xyz, round << 2 | k);
    FOUR_WORDS(links)[2u * u].row = uvec4(links_u.xyz, round << 2 | j);
    return true;
}

// What is left of a side of a round's item for the next round.
struct Handed {
    bool some;
    uint side;
    uint outer;
    uint mark;
    // Whether what is outside was flipped in the same round.
    bool flipped;
};

// The two triangles of a flip have four outer sides, k from 0 to 3.
uint side_of(uvec2 edge, uint k) {
    uint h = (k & 1u) == 0u ? edge.x : edge.y;
    return k < 2u ? h : prev_edge(h);
}

// Step 3, second half, after all flips of the round: what is outside of an outer side now. The outer edge behind a flipped
// one went over to the other triangle, on this side as on the far side. An edge between two flips is handed on by both sides
// alike, but only the lower one does.
Handed look_out(MESH links, uint round, uint side) {
    Handed handed;
    handed.side = side;
    uint outer = link_of(links, side);
    handed.mark = outer & CONSTRAINED;
    outer &= HALF_EDGE;
    uint o = outer / 3u;
    uvec4 beyond = FOUR_WORDS(links)[2u * o].row;
    handed.flipped = beyond.w >> 2 == round;
    if (handed.flipped) {
        uint behind = turned(beyond.w & 3u, 1u);
        outer = outer == 3u * o + behind ? prev_edge(pick(beyond, behind)) : outer;
    }
    handed.outer = outer;
    handed.some = !handed.flipped || side < outer;
    return handed;
}

// The link that follows from it. To be written after all is read: what has been written near is no longer at hand.
void renew(MESH links, Handed handed) {
    uint at = handed.flipped ? handed.side : handed.outer;
    uint to = handed.flipped ? handed.outer : handed.side;
    set_link(links, at, to | handed.mark);
}

// The same for an illegal edge that was not flipped: it stays active, unless a flip beside it hands it on.
Handed leave(MESH links, uint round, uvec2 edge) {
    Handed handed;
    handed.some = STAMP(edge.x / 3u) >> 2 != round && STAMP(edge.y / 3u) >> 2 != round;
    handed.side = edge.x;
    handed.outer = edge.y;
    handed.mark = 0u;
    handed.flipped = false;
    return handed;
}

#endif
