// Unpin: tries the pinned sites whose turn it is at their true positions, and frees those around which the triangles stay
// counterclockwise. The others wait for the next round, and remember whom for: while that one waits, so do they.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    Points positions;
    U32 state;
    ReadPositions points; // by input index
    ReadU32 order;
    ReadU32 all;   // half-edges out of the pinned sites, by place
    U32 waiting;   // places of sites not tried yet, for rounds but the first
    U32 later;     // the same for the next round
    ReadU32 rings; // STEPS words for each place: the neighbors in order
    U32 words;
    uint ring_limit; // places that there are rings for
    uint round;    // of the batch
};

struct Walk {
    uint start;
    uint at;
    bool closed;
};

// The ends of the spokes after the next few, and how many there are; what is behind them is DELETED, or repeats the first.
uint look(inout Walk walk, uint place, out uint ends[STEPS]) {
    uint count = 0u;
    if (place < ring_limit) {
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            ends[k] = rings.at[STEPS * place + k];
            count += uint(ends[k] != DELETED);
        }
        if (count != 0u) {
            walk.closed = true;
            return count;
        }
    }
    [[unroll]] for (uint k = 0u; k < STEPS; k++) {
        ends[k] = apex(triangles, walk.at);
        if (!walk.closed) {
            count++;
            walk.at = rotate_ccw(links, walk.at);
            walk.closed = walk.at == walk.start;
        }
    }
    return count;
}

// Of the neighbors that have to be tried before v, the one with the highest priority, or NONE.
uint last_before(uint start, uint place, uint v, uint stamp) {
    uint mine = priority(v);
    uint other = NONE;
    uint most = 0u;
    Walk walk = Walk(start, start, false);
    for (uint steps = 0u; !walk.closed && steps < MOST_TRIANGLES_OF_STAR; steps += STEPS) {
        uint ends[STEPS];
        uint states[STEPS];
        look(walk, place, ends);
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            states[k] = state.at[ends[k] < DELETED ? ends[k] : v];
        }
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            uint theirs = priority(ends[k]);
            if (ends[k] < DELETED && theirs < mine && theirs >= most && is_waiting(states[k], stamp)) {
                other = ends[k];
                most = theirs;
            }
        }
    }
    if (!walk.closed) {
        note_broken(words, v);
    }
    return other;
}

// Whether the triangles around v are counterclockwise with v there.
bool stays_counterclockwise(uint start, uint place, uint v, uvec4 at) {
    uint u = destination(triangles, start);
    uvec4 at_u = positions.at[u < DELETED ? u : v];
    Walk walk = Walk(start, start, false);
    for (uint steps = 0u; !walk.closed && steps < MOST_TRIANGLES_OF_STAR; steps += STEPS) {
        uint ends[STEPS];
        uvec4 where[STEPS];
        uint count = look(walk, place, ends);
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            where[k] = positions.at[ends[k] < DELETED ? ends[k] : v];
        }
        [[dont_unroll]] for (uint k = 0u; k < count; k++) {
            uint w = ends[k];
            if (max(u, w) < DELETED && orient2d(at, at_u, where[k]) != 1) {
                return false;
            }
            u = w;
            at_u = where[k];
        }
    }
    return true;
}

void main() {
    uint count = words.at[UNPIN_COUNTS + round];
    bool is_first = round == 0u && words.at[UNPIN_STARTED] == 1u;
    uint stamp = words.at[UNPIN_BASE] + round;
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint place = is_first ? i : waiting.at[i];
        uint start = all.at[place];
        uint v = origin(triangles, start);
        if (!is_first && is_waiting(state.at[state.at[v] & PLACE], stamp)) {
            later.at[append(words, UNPIN_COUNTS + round + 1u)] = place;
            continue;
        }
        uint other = last_before(start, place, v, stamp);
        if (other != NONE) {
            state.at[v] = PINNED | other;
            later.at[append(words, UNPIN_COUNTS + round + 1u)] = place;
            continue;
        }
        uvec4 at = points.at[order.at[v]];
        bool stuck = !stays_counterclockwise(start, place, v, at);
        if (!stuck) {
            positions.at[v] = at;
        }
        state.at[v] = PINNED | TRIED | (stuck ? 0u : FREED) | stamp;
    }
}
