// What a round is made of. Kernels that see what other invocations of the same dispatch wrote define COHERENT.
#ifndef ROUNDS_GLSL
#define ROUNDS_GLSL

#include "invocations.glsl"
#include "mesh.glsl"

BUFFER(SharedU32, uint, 4, coherent);
BUFFER(MaybeU32, uint, 4, );

#ifdef COHERENT
#define WORDS SharedU32
#define MESH SharedRows
#else
#define WORDS U32
#define MESH Rows
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

// State is three arrays of `stride` words: by triangle the least priority that claims it, in even and in odd rounds, else NONE;
// and its stamp, four times the last round that flipped it, plus the edge along which it was. (Three words side by side
// made rounds slower by a fifth: neighbors' claims share sectors.)
#define CLAIM(H, PARITY) ((PARITY) * stride + (H) / 3u)
#define STAMP(H) (2u * stride + (H) / 3u)

// Step 2: an illegal edge claims its two triangles, in the name of its lower half-edge.
void claim(WORDS state, uint stride, uint parity, uint lower, uint upper) {
    uint mine = priority(lower);
    atomicMin(state.at[CLAIM(lower, parity)], mine);
    atomicMin(state.at[CLAIM(upper, parity)], mine);
}

// Step 3, first half: flips h, whose twin is g, if it has both its triangles; then nobody else touches their links. Outer
// links keep the names that they had before the round.
void flip_pair(MESH triangles, MESH links, WORDS state, uint stride, uint round, uint h, uint g) {
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint t_outer = link_of(links, h1);
    uint u_outer = link_of(links, g1);
    uint c = apex(triangles, h);
    uint d = apex(triangles, g);
    set_apex(triangles, prev_edge(h), d);
    set_apex(triangles, prev_edge(g), c);
    set_link(links, h, u_outer);
    set_link(links, g, t_outer);
    set_link(links, h1, g1);
    set_link(links, g1, h1);
    state.at[STAMP(h)] = round << 2 | h % 3u;
    state.at[STAMP(g)] = round << 2 | g % 3u;
}

// What is left of a side of a round's item for the next round.
struct Handed {
    bool some;
    uint side;
    uint outer;
    uint mark;
};

// The two triangles of a flip have four outer sides, k from 0 to 3.
uint side_of(uint h, uint g, uint k) {
    uint edge = (k & 1u) == 0u ? h : g;
    return k < 2u ? edge : prev_edge(edge);
}

// Step 3, second half, after all flips of the round: renews the link of an outer side. The outer edge behind the flipped one
// went over to the other triangle, on this side as on the far side. An edge between two flips is renewed and handed on by
// both sides alike, but only the lower one hands it on.
Handed renew(MESH links, WORDS state, uint stride, uint round, uint side) {
    Handed handed;
    handed.side = side;
    uint outer = link_of(links, side);
    handed.mark = outer & CONSTRAINED;
    outer &= HALF_EDGE;
    uint stamp = state.at[STAMP(outer)];
    bool flipped = stamp >> 2 == round;
    if (flipped) {
        uint edge = outer - outer % 3u + (stamp & 3u);
        outer = outer == next_edge(edge) ? prev_edge(link_of(links, outer)) : outer;
        set_link(links, side, outer | handed.mark);
    } else {
        set_link(links, outer, side | handed.mark);
    }
    handed.outer = outer;
    handed.some = !flipped || side < outer;
    return handed;
}

// The same for an illegal edge that was not flipped: it stays active, unless a flip beside it hands it on. It gives back what
// it claimed. A link that another invocation renews meanwhile leads to the same triangles before and after.
Handed leave(MESH links, WORDS state, uint stride, uint parity, uint round, uint h) {
    uint stamp = state.at[STAMP(h)];
    bool flipped = stamp >> 2 == round;
    uint side = h;
    if (flipped && h == next_edge(h - h % 3u + (stamp & 3u))) {
        side = prev_edge(link_of(links, h));
    }
    uint g = twin(links, side);
    state.at[CLAIM(h, parity)] = NONE;
    state.at[CLAIM(g, parity)] = NONE;
    Handed handed;
    handed.some = !flipped && state.at[STAMP(g)] >> 2 != round;
    handed.side = h;
    handed.outer = g;
    handed.mark = 0u;
    return handed;
}

#endif
