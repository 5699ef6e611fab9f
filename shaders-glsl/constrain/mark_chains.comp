// Steps 2 and 3 of an outer round: walkers claim each triangle that they cross; the least word says who owns it. Who finds a
// lower word, or has its own replaced, does not own its whole chain. Walkers first, then later pieces of walkers.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "claims.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    ReadU32x2 sub_constraints;
    ReadU32 walkers;
    ReadU32 firsts;
    ReadU32 runs; // by walker: where its later pieces stand, or NONE
    U32x4 pieces;
    ReadU32 piece_count;
    WriteU32 piece_walked; // by later piece, the triangles that it crossed; then, by the first of them, those of the one before
    U32 lost;
    U32 state; // of which the stamps say who got its owner in this round
    U32 words;
    uint stride;
    uint piece_limit;
    uint hub_walk; // triangles that the first walk from a hub claims at most
};

shared uint walked;

void main() {
    uint count = words.at[ADMITTED];
    uint end = count == 0u ? 0u : count + min(piece_count.at[0], piece_limit);
    uint stamp = words.at[ROUND] << 2 | LISTED;
    uint longest = words.at[LONGEST];
    if (gl_LocalInvocationIndex == 0u) {
        walked = 0u;
    }
    barrier();
    uint sum = 0u;
    for (uint i = item_index(); i < end; i += item_stride()) {
        bool later = i >= count;
        uint s;
        uint begins = NONE;
        uint h = NONE;
        bool walks = false;
        uint farthest = NONE;
        uint number = 0u;
        uint run;
        uint rest; // the pieces from there on are those after this one
        uint rest_end = 0u;
        if (later) {
            rest = i - count;
            uvec4 piece = pieces.at[rest];
            s = piece.x;
            h = piece.z;
            number = piece_number(piece);
            run = first_piece(piece, rest);
            rest_end = pieces_end(piece, run);
            rest++;
        } else {
            s = walkers.at[i];
            begins = firsts.at[s];
            h = begins & HALF_EDGE;
            uint known = lost.at[s];
            walks = true;
            if ((known & AT_HUB) != 0u) {
                uint before = known / WALKED_ONCE;
                uint64_t triangles = uint64_t(hub_walk) * uint64_t(4u + before) / 4ul << min(before / 16u, 20u);
                farthest = uint(min(triangles, uint64_t(NONE)));
                atomicAdd(lost.at[s], WALKED_ONCE);
            }
            run = runs.at[s];
            rest = run;
            if (run != NONE) {
                rest_end = pieces_end(pieces.at[run], run);
            }
        }
        uint until = rest_end == 0u ? NONE : next_beginning(pieces, rest, rest_end);
        uint steps = 0u;
        // Where a piece would begin at a vertex, the one before runs through that.
        if (later && h != until && (h & AT_VERTEX) == 0u) {
            walks = true;
            begins = firsts.at[s];
        }
        if (walks) {
            uvec2 ends = sub_constraints.at[s];
            // Words are those of the direction from the lower end to the higher one.
            bool reversed = (begins & REVERSED) != 0u;
            ends = reversed ? ends.yx : ends;
            Point a = point_at(positions, ends.x);
            Point b = point_at(positions, ends.y);
            uint mine = scatter(s, OWNER_BITS) << 4;
            uint entered = NO_EDGE;
            uint fault = ASTRAY;
            bool owns = !later;
            bool has_lost = false;
            bool by_flips = (lost.at[s] & BY_FLIPS) != 0u;
            // Claims are settled one step later, so that no step waits for them: the triangle, the word, what was there.
            uvec3 claimed = uvec3(NONE);
            uvec3 before = uvec3(NONE);
            // No walk crosses an edge twice.
            uint most = 2u * stride;
            for (uint step = 0u; step < most; step++) {
                uint g = link_of(links, h);
                if (owns) {
                    uint edge = h % 3u;
                    uint word = mine | (reversed ? entered << 2 | edge : edge << 2 | entered);
                    claimed = uvec3(h / 3u, word, atomicMin(state.at[OWNED(h / 3u)], word));
                    steps++;
                    if (h == until) {
                        fault = NONE;
                        break;
                    }
                    if (steps == farthest) {
                        lose(lost, words, s);
                        has_lost = true;
                        atomicAdd(words.at[PARTIAL_WALKS], 1u);
                        fault = NONE;
                        break;
                    }
                }
                owns = true;
                if ((g & CONSTRAINED) != 0u) {
                    fault = g == NONE ? ASTRAY : BLOCKED;
                    break;
                }
                entered = g % 3u;
                uint w = apex(triangles, g);
                if (w >= DELETED) {
                    break;
                }
                Point corner = point_at(positions, w);
                if (before.x != NONE) {
                    has_lost = settle_claim(
                        state, lost, words, s, before.y, before.z, before.x, stamp, has_lost, by_flips);
                }
                before = claimed;
                claimed.x = NONE;
                int side = orient2d(a, b, corner);
                if (side == 0) {
                    uint word = mine | (reversed ? entered << 2 | NO_EDGE : NO_EDGE << 2 | entered);
                    claimed = uvec3(g / 3u, word, atomicMin(state.at[OWNED(g / 3u)], word));
                    steps++;
                    fault = w == ends.y ? NONE : THROUGH_VERTEX;
                    if (reversed && (lost.at[s] & AT_HUB) == 0u) {
                        atomicOr(lost.at[s], g / 3u << LOW_SHIFT);
                    }
                    if (run != NONE) {
                        atomicMin(pieces.at[run].w, number);
                    }
                    break;
                }
                h = side > 0 ? next_edge(g) : prev_edge(g);
            }
            for (uint k = 0u; k < 2u; k++) {
                if (before.x != NONE) {
                    has_lost = settle_claim(
                        state, lost, words, s, before.y, before.z, before.x, stamp, has_lost, by_flips);
                }
                before = claimed;
            }
            if (fault != NONE) {
                atomicMin(words.at[WALK_FAULT], s << 2 | fault);
            }
        }
        if (later) {
            piece_walked.at[i - count] = steps;
        } else {
            sum += steps;
            if (run != NONE) {
                piece_walked.at[piece_limit + run] = steps;
            } else if (steps > longest) {
                atomicOr(lost.at[s], LONG);
            }
        }
    }
    atomicAdd(walked, sum);
    barrier();
    if (gl_LocalInvocationIndex == 0u && walked != 0u) {
        add_wide(words, WALKED, walked);
    }
}
