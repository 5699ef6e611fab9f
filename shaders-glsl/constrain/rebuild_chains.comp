// Step 4 of an outer round: of each walker that owns its whole chain, if that is short, the triangles are replaced at once; the
// walker becomes an edge. `rebuild` of the reference. Those whose chains are too long are told here, and go by flips from then
// on. Also sums up what pieces of walks crossed.
//
// One invocation goes through a chain. On either side of the walker it keeps a stack of the vertices that could not be cut off
// yet. Where a neighbor is rebuilt in this dispatch as well, by whichever invocation, half-edges on both sides of their edge
// get new names: who comes first leaves the new name, and who comes second joins the two.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32 walkers;
    ReadU32 runs;
    ReadU32x4 pieces;
    ReadU32 piece_count;
    ReadU32 piece_walked; // by later piece, and behind these, by the first of them, of the piece before
    U32 lost;
    U32 state;
    U32 spokes;
    U32 degrees;
    U32 words;
    uint piece_limit;
};

// Triangles of the longest chain, at most; and corners on both sides together, of which one of the ends is on both.
const uint MOST = 62u;
const uint ROOM = MOST + 2u;
// An edge of a polygon: the half-edge on its other side, with the mark of a constrained edge. Or, if that gets a new name too,
// with MEETS, the lower one of the old names of the two.
const uint MEETS = 0x40000000u;
const uint NAME = 0x3fffffffu;

shared uint walked;
shared uint rebuilt;

// Whether the chain of a walker is too long.
bool is_long(uint s) {
    if ((lost.at[s] & BY_FLIPS) != 0u) {
        return true;
    }
    uint run = runs.at[s];
    if (run == NONE) {
        return false;
    }
    uvec4 first = pieces.at[run];
    uint longest = words.at[LONGEST];
    uint sum = piece_walked.at[piece_limit + run];
    // Those behind the first piece that came to the end are superfluous.
    uint end = min(pieces_end(first, run), run + first.w);
    for (uint p = run; p < end && sum <= longest; p++) {
        sum += piece_walked.at[p];
    }
    return sum > longest;
}

// Whether a triangle with this word is one of a chain that is rebuilt in this dispatch.
bool moves(uint word) {
    if (word == FREE) {
        return false;
    }
    uint s = owner_of(word);
    uint known = lost.at[s];
    return known != DONE && (known & (LOSES | BARRED)) == 0u && !is_long(s);
}

// What a link of a chain is, given the word of the triangle on the other side.
uint edge_of(uint side, uint outer, uint word) {
    uint mark = outer & CONSTRAINED;
    outer &= HALF_EDGE;
    return moves(word) ? mark | MEETS | min(outer, side) : mark | outer;
}

// A new half-edge takes its place on an edge.
void join(uint new, uint edge) {
    uint other = edge & NAME;
    if ((edge & MEETS) != 0u) {
        // Each half-edge has a word of its own, which is no half-edge before.
        uint t = other / 3u;
        uint at = 4u * t + other % 3u;
        other = atomicExchange(state.at[at], new);
        if (other > NAME) {
            return;
        }
        state.at[at] = at == STAMP(t) ? ~(words.at[ROUND] << 2 | LISTED) : NONE;
    }
    link_marked(links, new, other, edge & CONSTRAINED);
}

// A vertex that comes to a side, and what was read for it one turn ahead: reads wait for each other as little as can be.
struct Arrival {
    uint vertex;
    Point point;
    uint side;  // the half-edge of the chain that leads to it from the vertex before,
    uint outer; // its link,
    uint word;  // and the word of the triangle there
    uint slot;
    bool is_left;
};

uint pick(uvec3 of, uint k) {
    return k == 0u ? of.x : k == 1u ? of.y : of.z;
}

// The arrival by a half-edge of the triangle with these links.
Arrival arrives(uint vertex, uvec3 of, uint t, uint k, uint slot, bool is_left) {
    uint outer = pick(of, k);
    uint word = state.at[OWNED((outer & HALF_EDGE) / 3u)];
    return Arrival(vertex, point_at(positions, vertex), 3u * t + k, outer, word, slot, is_left);
}

// Whether it was done, as it is in any triangulation. Of a chain the triangle at the lower end.
bool rebuild(uint first) {
    uint vertex[ROOM];
    uint edges[ROOM];
    uint slots[ROOM];
    uint word = state.at[OWNED(first)];
    uvec3 cornered = corners(triangles, first);
    uvec3 linked = links_of(links, first);
    uint j = outward(word);
    uint low = pick(cornered, j);
    uint g = pick(linked, j) & HALF_EDGE;
    // The stack of the left side grows upward, that of the right side downward: the places of their tops, and the points there.
    uint left_top = 0u;
    uint right_top = ROOM - 1u;
    vertex[0] = low;
    vertex[ROOM - 1u] = low;
    Point left_point = point_at(positions, low);
    Point right_point = left_point;
    uint at_low = 0u;
    uint at_high = 0u;
    // Two vertices of the first triangle, one of each other; the last one comes to both sides.
    Arrival next = arrives(pick(cornered, turned(j, 2u)), linked, first, turned(j, 1u), g / 3u, true);
    Arrival other = arrives(pick(cornered, turned(j, 1u)), linked, first, turned(j, 2u), first, false);
    word = state.at[OWNED(g / 3u)];
    cornered = corners(triangles, g / 3u);
    linked = links_of(links, g / 3u);
    uint ends_at = NONE;
    [[dont_unroll]] for (uint turn = 0u; turn < ROOM; turn++) {
        Arrival now = next;
        if (turn == 0u || turn == ends_at) {
            next = other;
        } else if (turn < ends_at) {
            uint t = g / 3u;
            j = g - 3u * t;
            uint gate = outward(word);
            uint vertex = pick(cornered, j);
            if (gate == NO_EDGE) {
                ends_at = turn + 1u;
                next = arrives(vertex, linked, t, turned(j, 2u), NONE, true);
                other = arrives(vertex, linked, t, turned(j, 1u), NONE, false);
            } else {
                g = pick(linked, gate) & HALF_EDGE;
                bool is_left = gate == turned(j, 1u);
                next = arrives(vertex, linked, t, turned(j, is_left ? 2u : 1u), g / 3u, is_left);
                word = state.at[OWNED(g / 3u)];
                cornered = corners(triangles, g / 3u);
                linked = links_of(links, g / 3u);
            }
        }
        bool ended = turn >= ends_at;
        uint edge = edge_of(now.side, now.outer, now.word);
        uint top = now.is_left ? left_top : right_top;
        uint bottom = now.is_left ? 0u : ROOM - 1u;
        Point middle = now.is_left ? left_point : right_point;
        // Each turn cuts a vertex off.
        while (top != bottom) {
            uint below = now.is_left ? top - 1u : top + 1u;
            uint u = vertex[top];
            uint p = vertex[below];
            Point before = point_at(positions, p);
            if (orient2d(now.is_left ? now.point : before, middle, now.is_left ? before : now.point) <= 0) {
                break;
            }
            uint t = slots[top];
            set_corners(triangles, t, u, now.is_left ? p : now.vertex, now.is_left ? now.vertex : p);
            join(3u * t + 1u, now.is_left ? edge : edges[top]);
            join(3u * t + 2u, now.is_left ? edges[top] : edge);
            spokes.at[u] = 3u * t + 2u;
            at_low += uint(below == bottom);
            at_high += uint(ended);
            edge = 3u * t;
            top = below;
            middle = before;
        }
        if (ended) {
            if (top != bottom) {
                return false;
            }
            if (turn > ends_at) {
                uint left = edges[0];
                link_marked(links, left, edge, CONSTRAINED);
                spokes.at[low] = left;
                spokes.at[now.vertex] = edge;
                atomicAdd(degrees.at[low], at_low - 1u);
                atomicAdd(degrees.at[now.vertex], at_high - 1u);
                return true;
            }
            edges[0] = edge;
        } else {
            top = now.is_left ? top + 1u : top - 1u;
            vertex[top] = now.vertex;
            edges[top] = edge;
            slots[top] = now.slot;
        }
        if (now.is_left) {
            left_top = top;
            left_point = now.point;
        } else {
            right_top = top;
            right_point = now.point;
        }
    }
    return false;
}

void main() {
    bool fails = has_failed(words);
    uint end = fails ? 0u : words.at[ADMITTED];
    uint piece_end = end == 0u ? 0u : min(piece_count.at[0], piece_limit);
    if (gl_LocalInvocationIndex == 0u) {
        walked = 0u;
        rebuilt = 0u;
    }
    barrier();
    for (uint p = item_index(); p < piece_end; p += item_stride()) {
        uvec4 piece = pieces.at[p];
        if (piece_number(piece) <= pieces.at[first_piece(piece, p)].w) {
            atomicAdd(walked, piece_walked.at[p]);
        }
    }
    bool flips = false;
    for (uint i = item_index(); i < end; i += item_stride()) {
        uint s = walkers.at[i];
        uint known = lost.at[s];
        if (is_long(s)) {
            flips = true;
            if ((known & BY_FLIPS) == 0u) {
                atomicOr(lost.at[s], LONG);
            }
        } else if ((known & LOSES) == 0u) {
            if (rebuild(known >> LOW_SHIFT)) {
                atomicAdd(rebuilt, 1u);
            } else {
                atomicMin(words.at[WALK_FAULT], s << 2 | ASTRAY);
            }
        }
    }
    if (flips) {
        words.at[MARKED] = 1u;
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) {
        if (walked != 0u) {
            add_wide(words, WALKED, walked);
        }
        if (rebuilt != 0u) {
            atomicAdd(words.at[INSERTED], rebuilt);
            atomicAdd(words.at[REBUILT], rebuilt);
        }
    }
}
