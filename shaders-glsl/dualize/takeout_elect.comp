// Take out: finds the pinned sites that go in this round, each with the half-edge to its heir. In the first turn those
// without a pinned neighbor of lower priority; they tell their pinned neighbors. Those who were told nothing have a second
// turn among each other. The others wait, and remember whom for: neighbors stay neighbors until one of them goes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadU32 state;
    ReadU32 waiting;  // sites
    WriteU32 later;   // sites, for the next turn
    WriteU32 winners; // half-edges
    U32 waits_for;    // for each site: whom for, and one more than the last round in which it was told
    U32 words;
    uint round; // of the batch
    uint turn;  // 0 or 1
};

// A walk goes both ways round, so many steps each at a time.
const uint HALF = STEPS / 2u;
// Neighbors that are kept, to be told.
const uint KEPT = 64u;

void main() {
    uint chain = words.at[CHAIN];
    // Set in an earlier round or in the turn before: the mesh is a chain.
    if (chain != 0u && chain <= round + turn) {
        return;
    }
    uint next = turn == 0u ? OUT_SECOND + round : OUT_COUNTS + round + 1u;
    uint count = words.at[(turn == 0u ? OUT_COUNTS : OUT_SECOND) + round];
    // Of all rounds there were.
    uint now = words.at[OUT_ROUNDS] + round + 1u;
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint v = waiting.at[i];
        uint other = waits_for.at[2u * v];
        bool beaten = turn == 1u && waits_for.at[2u * v + 1u] == now;
        if (!beaten && other != NONE && (state.at[other] & PINNED) != 0u) {
            beaten = turn == 0u || waits_for.at[2u * other + 1u] != now;
        }
        if (beaten) {
            later.at[append(words, next)] = v;
            continue;
        }
        uint mine = priority(v);
        // Of the neighbors that go before, of the first few, the one with the highest priority.
        uint most = 0u;
        uint start = state.at[v] & PLACE;
        bool finite = false;
        uint heir = NONE;
        uint to_heir = start;
        uint kept[KEPT];
        uint kept_count = 0u;
        // The last half-edges counterclockwise and clockwise.
        uint h = start;
        uint g = start;
        uint steps = 0u;
        bool closed = false;
        while (!closed && !beaten && steps < MOST_TRIANGLES_OF_STAR) {
            uint spokes[STEPS];
            uint ends[STEPS];
            uint states[STEPS];
            uint told[STEPS];
            [[unroll]] for (uint k = 0u; k < HALF; k++) {
                bool first = steps + k == 0u;
                uint ccw = first ? start : rotate_ccw(links, h);
                uint cw = rotate_cw(links, g);
                // Where they have met, those of the last step once more.
                closed = closed || ccw == g && !first;
                h = closed ? h : ccw;
                closed = closed || cw == h;
                g = closed ? g : cw;
                spokes[2u * k] = h;
                spokes[2u * k + 1u] = g;
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                ends[k] = destination(triangles, spokes[k]);
                finite = finite || ends[k] < DELETED && apex(triangles, spokes[k]) < DELETED;
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                uint u = ends[k] < DELETED ? ends[k] : v;
                states[k] = state.at[u];
                told[k] = turn == 1u ? waits_for.at[2u * u + 1u] : 0u;
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                uint u = ends[k];
                if (u < DELETED) {
                    uint pinned = states[k] & PINNED;
                    uint theirs = priority(u);
                    bool open = pinned != 0u && (turn == 0u || told[k] != now);
                    if (open && theirs < mine && theirs >= most) {
                        beaten = true;
                        most = theirs;
                        other = u;
                    }
                    if ((pinned | u) < heir) {
                        heir = pinned | u;
                        to_heir = spokes[k];
                    }
                    if (turn == 0u && pinned != 0u) {
                        if (kept_count < KEPT) {
                            kept[kept_count] = u;
                        }
                        kept_count++;
                    }
                }
            }
            steps += HALF;
        }
        if (beaten) {
            waits_for.at[2u * v] = other;
            later.at[append(words, next)] = v;
        } else if (!closed) {
            note_broken(words, v);
        } else if (!finite) {
            words.at[CHAIN] = round + 1u;
        } else {
            winners.at[append(words, OUT_WINNERS + round)] = to_heir;
            for (uint k = 0u; k < min(kept_count, KEPT); k++) {
                waits_for.at[2u * kept[k] + 1u] = now;
            }
            if (kept_count > KEPT) {
                h = start;
                for (uint k = 0u; k < 2u * steps; k++) {
                    uint u = destination(triangles, h);
                    if (u < DELETED && (state.at[u] & PINNED) != 0u) {
                        waits_for.at[2u * u + 1u] = now;
                    }
                    h = rotate_ccw(links, h);
                    if (h == start) {
                        break;
                    }
                }
            }
        }
    }
}
