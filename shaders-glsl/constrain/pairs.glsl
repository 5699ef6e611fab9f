// Inner rounds: pairs of triangles with the same owner are flipped. `inner` of the reference.
//
// Triangles have a state: see `insert.glsl`.
#ifndef PAIRS_GLSL
#define PAIRS_GLSL

#include "insert.glsl"

// A pair (A, C) that may be flipped: A, C, and the two words of its entry in a list; or nothing, with A NONE.
struct Candidate {
    uint a;
    uint c;
    uvec2 entry;
};

const Candidate NO_PAIR = Candidate(NONE, NONE, uvec2(NONE));

uint key_of(uvec2 entry) {
    return (entry.y & ~NO_B) | scatter((entry.x & HALF_EDGE) / 3u, CLAIM_BITS);
}

void claim(WORDS state, uint parity, Candidate pair) {
    uint key = key_of(pair.entry);
    uint b = pair.entry.y & NO_B;
    atomicMin(state.at[CLAIM(pair.a, parity)], key);
    atomicMin(state.at[CLAIM(pair.c, parity)], key);
    if (b != NO_B) {
        atomicMin(state.at[CLAIM(b, parity)], key);
    }
}

// Whether a candidate has all that it claimed. Who does not have the first triangle may read what another changes, and
// does not look at it. A pair that was held during walks does not win if any of its triangles got another owner since: `since`
// is the round before these, NONE for others.
bool wins(MESH links, WORDS state, uint parity, uvec2 entry, uint since) {
    uint key = key_of(entry);
    uint b = entry.y & NO_B;
    if (since != NONE && stamp_of(state, entry.x / 3u) >> 2 >= since) {
        return false;
    }
    if (state.at[CLAIM(entry.x / 3u, parity)] != key || (b != NO_B && state.at[CLAIM(b, parity)] != key)) {
        return false;
    }
    uint c = twin(links, entry.x) / 3u;
    if (since != NONE) {
        uint latest = max(stamp_of(state, c), b == NO_B ? 0u : stamp_of(state, b));
        if (latest >> 2 >= since) {
            return false;
        }
    }
    return state.at[CLAIM(c, parity)] == key;
}

// How many pairs, the first in the list of this round, were held during walks in which triangles got other owners.
uint held_pairs(WORDS words, uint round) {
    return words.at[STOLEN] != 0u && words.at[HELD_ROUND] + 1u == round ? words.at[HELD] : 0u;
}

bool is_flipped(uint stamp, uint round) {
    return stamp >> 2 == round && (stamp & 3u) != LISTED;
}

// What has become of a pair that has all it claimed: the new edge is its owner; the owner still crosses it; or it was left as it
// is, since the edge to be flipped is a constrained one.
const uint INSERTS = 0u;
const uint FLIPS_ON = 1u;
const uint IS_BLOCKED = 2u;

// Flips h, from A to C, both of the same owner; nobody else touches them. Outer links keep the names that they had before the
// round.
uint flip_pair(
    MESH triangles, MESH links, WORDS state, WORDS spokes, WORDS degrees, WORDS words, uint round, uint h
) {
    uint g = twin(links, h);
    uint t = h / 3u;
    uint u = g / 3u;
    uint k = h - 3u * t;
    uint j = g - 3u * u;
    uint k1 = turned(k, 1u);
    uint j1 = turned(j, 1u);
    uvec4 corners_t = FOUR_WORDS(triangles)[2u * t].row;
    uvec4 corners_u = FOUR_WORDS(triangles)[2u * u].row;
    uvec4 links_t = FOUR_WORDS(links)[2u * t].row;
    uvec4 links_u = FOUR_WORDS(links)[2u * u].row;
    uint near = pick(corners_t, k);
    uint right = pick(corners_t, k1);
    uint left = pick(corners_t, turned(k, 2u));
    uint far = pick(corners_u, j);
    uint t_outer = pick(links_t, k1);
    uint u_outer = pick(links_u, j1);
    uint word = state.at[OWNED(t)];
    if ((pick(links_t, k) & CONSTRAINED) != 0u) {
        // What crosses the owner came to be an edge by the owner's flips, which need not have walked since.
        atomicMin(words.at[WALK_FAULT], owner_of(word) << 2 | BLOCKED);
        return IS_BLOCKED;
    }
    int near_side = side_of(word);
    int far_side = side_of(state.at[OWNED(u)]);
    bool zero = near_side == 0 && far_side == 0;
    uint mark = zero ? CONSTRAINED : 0u;
    FOUR_WORDS(triangles)[2u * t].row = replaced(corners_t, turned(k, 2u), far);
    FOUR_WORDS(triangles)[2u * u].row = replaced(corners_u, turned(j, 2u), near);
    FOUR_WORDS(links)[2u * t].row = replaced(replaced(links_t, k, u_outer), k1, 3u * u + j1 | mark);
    FOUR_WORDS(links)[2u * u].row = replaced(replaced(links_u, j, t_outer), j1, 3u * t + k1 | mark);
    state.at[STAMP(t)] = ~(round << 2 | k);
    state.at[STAMP(u)] = ~(round << 2 | j);
    // Corners from k on: near, right, far in t; from j on far, left, near in u.
    uint t_in = near_side == 1 ? turned(k, 2u) : near_side == -1 && far_side == 1 ? turned(k, 1u) : NO_EDGE;
    uint t_out = far_side == 1 ? k : far_side == -1 && near_side == 1 ? turned(k, 1u) : NO_EDGE;
    uint u_in = near_side == -1 ? j : near_side == 1 && far_side == -1 ? turned(j, 1u) : NO_EDGE;
    uint u_out = far_side == -1 ? turned(j, 2u) : far_side == 1 && near_side == -1 ? turned(j, 1u) : NO_EDGE;
    state.at[OWNED(t)] = near_side == 1 || far_side == 1 ? (word & ~15u) | t_out << 2 | t_in : FREE;
    state.at[OWNED(u)] = near_side == -1 || far_side == -1 ? (word & ~15u) | u_out << 2 | u_in : FREE;
    // Half-edges of the other two still leave them. Each vertex may be that of several flips; what any of them writes will do.
    spokes.at[right] = h;
    spokes.at[left] = g;
    // Vertices where many sub-constraints end come to have many edges. Nothing else is to be known of degrees.
    if (near_side == 0) {
        atomicAdd(degrees.at[near], 1u);
    }
    if (far_side == 0) {
        atomicAdd(degrees.at[far], 1u);
    }
    return zero ? INSERTS : FLIPS_ON;
}

// The other side of a half-edge after the flips of a round, whether its link has been renewed or not. The outer edge behind
// a flipped one went over to the other triangle.
uint resolved(MESH links, WORDS state, uint round, uint side) {
    uint outer = twin(links, side);
    if (round == NONE) {
        return outer;
    }
    uint stamp = stamp_of(state, side / 3u);
    if (is_flipped(stamp, round) && side == next_edge(side - side % 3u + (stamp & 3u))) {
        return outer;
    }
    stamp = stamp_of(state, outer / 3u);
    if (is_flipped(stamp, round) && outer == next_edge(outer - outer % 3u + (stamp & 3u))) {
        return prev_edge(twin(links, outer));
    }
    return outer;
}

// The link of an outer side of a flip that is to be renewed, and what it becomes.
uvec2 renewed(MESH links, WORDS state, uint round, uint side) {
    uint outer = link_of(links, side);
    uint mark = outer & CONSTRAINED;
    outer &= HALF_EDGE;
    uint stamp = stamp_of(state, outer / 3u);
    if (is_flipped(stamp, round)) {
        if (outer == next_edge(outer - outer % 3u + (stamp & 3u))) {
            outer = prev_edge(twin(links, outer));
        }
        return uvec2(side, outer | mark);
    }
    return uvec2(outer, side | mark);
}

// Whether this invocation is the first to list a triangle that was not flipped.
bool lists(WORDS state, uint round, uint t) {
    if (stamp_of(state, t) >> 2 == round) {
        return false;
    }
    return ~atomicMin(state.at[STAMP(t)], ~(round << 2 | LISTED)) >> 2 != round;
}

// What one of four lanes of an item looks at: a triangle, or NONE; the pair, where it is known to be one still; and a link to be
// renewed, with what it becomes, or NONE.
struct Look {
    uint a;
    Candidate known;
    uvec2 link;
};

// Writes a link that is to be renewed: after all is read, since what has been written near is no longer at hand.
void renew(MESH links, Look look) {
    if (look.link.x != NONE) {
        set_link(links, look.link.x, look.link.y);
    }
}

// Finds what link to renew around a flip, gives claimed triangles back, and finds what to look at again: the two triangles of a flip,
// the one before and the one after them; and the first triangle of a pair that was not flipped.
Look settle(MESH links, WORDS state, uint parity, uint round, uvec2 entry, uint lane) {
    Look look = Look(NONE, NO_PAIR, uvec2(NONE));
    uint h = entry.x & HALF_EDGE;
    uint b = entry.y & NO_B;
    uint t = h / 3u;
    if ((entry.x & WON) == 0u) {
        if (lane != 0u) {
            return look;
        }
        uint stamp = stamp_of(state, t);
        uint side = h;
        if (is_flipped(stamp, round) && h == next_edge(h - h % 3u + (stamp & 3u))) {
            side = prev_edge(twin(links, h));
        }
        // If it was flipped, who flipped it gives it back.
        uint c = twin(links, side) / 3u;
        state.at[CLAIM(t, parity)] = NONE;
        state.at[CLAIM(c, parity)] = NONE;
        if (b != NO_B) {
            state.at[CLAIM(b, parity)] = NONE;
        }
        if (lists(state, round, t)) {
            look.a = t;
            bool changed = is_flipped(stamp_of(state, c), round);
            if (b != NO_B) {
                changed = changed || is_flipped(stamp_of(state, b), round);
            }
            if (!changed) {
                look.known = Candidate(t, c, entry);
            }
        }
        return look;
    }
    uint g = prev_edge(twin(links, next_edge(h)));
    uint u = g / 3u;
    uint of_t = state.at[OWNED(t)];
    uint of_u = state.at[OWNED(u)];
    uint edge = (lane & 1u) == 0u ? h : g;
    look.link = renewed(links, state, round, lane < 2u ? edge : prev_edge(edge));
    if (lane < 2u) {
        state.at[CLAIM(lane == 0u ? t : u, parity)] = NONE;
        look.a = lane == 0u ? (of_t == FREE ? NONE : t) : (of_u == FREE ? NONE : u);
        return look;
    }
    if (lane == 2u && b != NO_B) {
        state.at[CLAIM(b, parity)] = NONE;
    }
    if (of_t == FREE && of_u == FREE) {
        return look;
    }
    bool t_first = of_u == FREE || (of_t != FREE && outward(of_t) == next_edge(h) - 3u * t);
    bool t_last = of_u == FREE || (of_t != FREE && !t_first);
    bool at_t = lane == 2u ? t_first : t_last;
    uint word = at_t ? of_t : of_u;
    uint gate = lane == 2u ? inward(word) : outward(word);
    if (gate != NO_EDGE) {
        uint x = resolved(links, state, round, 3u * (at_t ? t : u) + gate) / 3u;
        if (same_owner(word, state.at[OWNED(x)]) && lists(state, round, x)) {
            look.a = x;
        }
    }
    return look;
}

#endif
