// Take out: finds the pinned sites that go in this round, those without a pinned neighbor of lower priority; each with the
// half-edge to its heir. The others wait, and remember whom for: neighbors stay neighbors until one of them goes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadU32 state;
    ReadU32 waiting; // sites
    WriteU32 later;  // sites, for the next round
    WriteU32 winners; // half-edges
    U32 waits_for;    // two words for each site, the first of them
    U32 words;
    uint round; // of the batch
};

void main() {
    uint chain = words.at[CHAIN];
    // Set in an earlier round: the mesh is a chain.
    if (chain != 0u && chain <= round) {
        return;
    }
    uint count = words.at[OUT_COUNTS + round];
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint v = waiting.at[i];
        uint other = waits_for.at[2u * v];
        if (other != NONE && (state.at[other] & PINNED) != 0u) {
            later.at[append(words, OUT_COUNTS + round + 1u)] = v;
            continue;
        }
        uint mine = priority(v);
        // Of the neighbors that go before, of the first few, the one with the highest priority.
        uint most = 0u;
        uint start = state.at[v] & PLACE;
        bool beaten = false;
        bool finite = false;
        uint heir = NONE;
        uint to_heir = start;
        uint h = start;
        uint steps = 0u;
        bool closed = false;
        while (!closed && !beaten && steps < MOST_TRIANGLES_OF_STAR) {
            uint spokes[STEPS];
            uint ends[STEPS];
            uint states[STEPS];
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                spokes[k] = h;
                ends[k] = destination(triangles, h);
                finite = finite || ends[k] < DELETED && apex(triangles, h) < DELETED;
                if (!closed) {
                    h = rotate_ccw(links, h);
                    closed = h == start;
                }
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                states[k] = state.at[ends[k] < DELETED ? ends[k] : v];
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                uint u = ends[k];
                if (u < DELETED) {
                    uint pinned = states[k] & PINNED;
                    uint theirs = priority(u);
                    if (pinned != 0u && theirs < mine && theirs >= most) {
                        beaten = true;
                        most = theirs;
                        other = u;
                    }
                    if ((pinned | u) < heir) {
                        heir = pinned | u;
                        to_heir = spokes[k];
                    }
                }
            }
            steps += STEPS;
        }
        if (beaten) {
            waits_for.at[2u * v] = other;
            later.at[append(words, OUT_COUNTS + round + 1u)] = v;
        } else if (!closed) {
            note_broken(words, v);
        } else if (!finite) {
            words.at[CHAIN] = round + 1u;
        } else {
            winners.at[append(words, OUT_WINNERS + round)] = to_heir;
        }
    }
}
