// What a round is made of. Kernels that see what other invocations of the same dispatch wrote define WORDS as `SharedU32`.
#ifndef ROUNDS_GLSL
#define ROUNDS_GLSL

layout(local_size_x_id = 0, local_size_x = 256) in;

#include "groups.glsl"
#include "mesh.glsl"

BUFFER(SharedU32, uint, 4, coherent);
BUFFER(MaybeU32, uint, 4, );

#ifndef WORDS
#define WORDS U32
#endif

// The words that steer a round. Active edges that it takes: all, or none where it is another kernel's turn.
const uint TAKEN_COUNT = 0u;
// Illegal edges; and the same while the next ones are counted.
const uint ILLEGAL_COUNT = 1u;
const uint RELINK_COUNT = 2u;
// Edges that the filter left open.
const uint DEFERRED_COUNT = 3u;
// The number of this round, which never repeats while the stamps are kept.
const uint ROUND = 4u;

// The words of a report; flips and tests take two.
const uint REPORT_ROUNDS = 0u;
const uint REPORT_FLIPS = 1u;
const uint REPORT_TESTS = 3u;

// Which edges may be flipped: all, or those at the ghost vertex alone.
const uint SCOPE_ALL = 0u;
const uint SCOPE_HULL = 1u;

// The mark of an illegal edge that was flipped.
const uint WON = 0x80000000u;

uint item_index() {
    return group_index() * WORKGROUP + gl_LocalInvocationIndex;
}

uint item_stride() {
    return gl_NumWorkGroups.x * gl_NumWorkGroups.y * WORKGROUP;
}

// Adds to a number of two words, the low one first.
void add_wide(WORDS words, uint at, uint value) {
    uint old = atomicAdd(words.at[at], value);
    if (old + value < old) {
        atomicAdd(words.at[at + 1u], 1u);
    }
}

void claim(WORDS claims, uint h, uint g) {
    uint mine = priority(h);
    atomicMin(claims.at[h / 3u], mine);
    atomicMin(claims.at[g / 3u], mine);
}

// Flips h if it has both its triangles, whose links nobody else touches then. Outer links keep the names that they had
// before the round; a triangle's stamp says that it was flipped in this round, and along which edge.
bool flip_if_won(WORDS triangles, WORDS links, WORDS claims, WORDS stamps, uint round, uint h) {
    uint mine = priority(h);
    if (claims.at[h / 3u] != mine) {
        return false;
    }
    uint g = links.at[h];
    if (claims.at[g / 3u] != mine) {
        return false;
    }
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint t_outer = links.at[h1];
    uint u_outer = links.at[g1];
    uint c = triangles.at[h];
    uint d = triangles.at[g];
    triangles.at[prev_edge(h)] = d;
    triangles.at[prev_edge(g)] = c;
    links.at[h] = u_outer;
    links.at[g] = t_outer;
    links.at[h1] = g1;
    links.at[g1] = h1;
    stamps.at[h / 3u] = round << 2 | h % 3u;
    stamps.at[g / 3u] = round << 2 | g % 3u;
    return true;
}

// The edges that a flipped or an illegal edge hands on to the next round, each by its lower half-edge.
struct Handed {
    uint count;
    uint edges[4];
};

// After all flips of the round: renews the outer links of the two triangles of a flip. The outer edge behind the flipped
// one went over to the other triangle, on this side as on the far side. An edge between two flips is renewed and handed on
// by both sides alike, but only the lower one hands it on.
Handed relink(WORDS triangles, WORDS links, WORDS claims, WORDS stamps, uint round, uint h) {
    uint g = prev_edge(links.at[next_edge(h)]);
    claims.at[h / 3u] = NONE;
    claims.at[g / 3u] = NONE;
    uint sides[4] = uint[4](h, g, prev_edge(h), prev_edge(g));
    Handed handed;
    handed.count = 0u;
    for (uint k = 0u; k < 4u; k++) {
        uint side = sides[k];
        uint outer = links.at[side];
        uint mark = outer & CONSTRAINED;
        outer &= HALF_EDGE;
        uint stamp = stamps.at[outer / 3u];
        bool flipped = stamp >> 2 == round;
        if (flipped) {
            uint edge = outer - outer % 3u + (stamp & 3u);
            outer = outer == next_edge(edge) ? prev_edge(links.at[outer]) : outer;
            links.at[side] = outer | mark;
        } else {
            links.at[outer] = side | mark;
        }
        if (!flipped || side < outer) {
            handed.edges[handed.count++] = min(side, outer);
        }
    }
    return handed;
}

// The same for an illegal edge that was not flipped: it stays active, unless a flip beside it hands it on. A link that
// another invocation renews meanwhile leads to the same two triangles before and after.
Handed leave(WORDS links, WORDS claims, WORDS stamps, uint round, uint h) {
    uint stamp = stamps.at[h / 3u];
    bool flipped = stamp >> 2 == round;
    uint side = h;
    if (flipped && h == next_edge(h - h % 3u + (stamp & 3u))) {
        side = prev_edge(links.at[h]);
    }
    uint u = twin(links, side) / 3u;
    claims.at[h / 3u] = NONE;
    claims.at[u] = NONE;
    flipped = flipped || stamps.at[u] >> 2 == round;
    Handed handed;
    handed.count = flipped ? 0u : 1u;
    handed.edges[0] = h;
    return handed;
}

#endif
