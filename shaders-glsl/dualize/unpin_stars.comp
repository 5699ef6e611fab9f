// Unpin: tries the pinned sites whose turn it is at their true positions, and frees those around which the triangles stay
// counterclockwise. The others wait for the next round.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    Points positions;
    U32 state;
    ReadPositions points; // by input index
    ReadU32 order;
    ReadU32 all;   // half-edges out of the pinned sites, for the first round
    U32 waiting;   // half-edges out of sites not tried yet, for other rounds
    U32 later;     // the same for the next round
    U32 deferred;  // half-edges out of sites that the other kernel decides
    U32 words;
    uint round;    // of the batch
    uint again;    // whether the deferred ones are to be decided
};

void main() {
    uint count = words.at[again != 0u ? UNPIN_DEFERRED + round : UNPIN_COUNTS + round];
    bool is_first = round == 0u && words.at[UNPIN_STARTED] == 1u;
    uint stamp = words.at[UNPIN_BASE] + round;
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint start = again != 0u ? deferred.at[i] : is_first ? all.at[i] : waiting.at[i];
        uint v = origin(triangles, start);
        uint mine = priority(v);
        uvec4 at = points.at[order.at[v]];
        bool beaten = false;
        bool stuck = false;
        bool open = false;
        uint u = destination(triangles, start);
        uvec4 at_u = positions.at[u < DELETED ? u : v];
        uint h = start;
        uint steps = 0u;
        bool closed = false;
        while (!closed && !beaten && steps < MOST_TRIANGLES_OF_STAR) {
            uint ends[STEPS]; // of the next spoke
            uint states[STEPS];
            uvec4 where[STEPS];
            uint count = 0u;
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                ends[k] = apex(triangles, h);
                if (!closed) {
                    count++;
                    h = rotate_ccw(links, h);
                    closed = h == start;
                }
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                uint w = ends[k] < DELETED ? ends[k] : v;
                states[k] = state.at[w];
                where[k] = positions.at[w];
            }
            // Each neighbor is the end of one spoke; what is behind the last one repeats the first.
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                beaten = beaten || ends[k] < DELETED && priority(ends[k]) < mine && is_waiting(states[k], stamp);
            }
            [[dont_unroll]] for (uint k = 0u; k < count && !beaten && !stuck; k++) {
                uint w = ends[k];
                if (max(u, w) < DELETED) {
                    int sign = orient2d(at, at_u, where[k]);
                    open = open || sign == UNDECIDED;
                    stuck = sign != 1 && sign != UNDECIDED;
                }
                u = w;
                at_u = where[k];
            }
            steps += STEPS;
        }
        if (beaten) {
            later.at[append(words, UNPIN_COUNTS + round + 1u)] = start;
            continue;
        }
        if (!closed) {
            note_broken(words, v);
        }
        if (open && !stuck) {
            deferred.at[append(words, UNPIN_DEFERRED + round)] = start;
            continue;
        }
        if (!stuck) {
            positions.at[v] = at;
        }
        state.at[v] = PINNED | TRIED | (stuck ? 0u : FREED) | stamp;
    }
}
