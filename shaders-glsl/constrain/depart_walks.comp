// Step 1 of an outer round: each sub-constraint that is to walk leaves the star of one of its ends: of a hub, or else of the end
// with fewer edges. In the first round it turns out which vertices are hubs. Who leaves a hub claims the triangle there. What
// has become an edge becomes a constrained one.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "claims.glsl"
#include "predicates.glsl"
#include "steps.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32x2 sub_constraints;
    ReadU32 spokes;
    ReadU32 degrees;
    ReadU32 counts; // by vertex: sub-constraints that walk and end there
    ReadU32 walkers;
    U32 firsts;
    U32 lost;
    U32 state;
    U32 words;
    uint most;        // spokes that any turn takes
    uint crowd;       // from so many sub-constraints on a vertex is a hub,
    uint most_spokes; // if it has no more edges than these
    uint longest;     // chains of up to so many triangles are rebuilt,
    uint least;       // if so many walk
};

bool is_hub(uint v) {
    return counts.at[v] >= crowd && degrees.at[v] <= most_spokes;
}

// The spoke with which to begin a turn about v, where a sub-constraint left it before across h.
uint spoke_near(uint h, uint v) {
    for (uint k = 0u; k < 3u; k++) {
        uint spoke = h - h % 3u + k;
        if (origin(triangles, spoke) == v) {
            return spoke;
        }
    }
    return spokes.at[v];
}

void main() {
    bool first = words.at[OUTER] == 0u;
    uint count = words.at[WALKERS];
    uint stamp = words.at[ROUND] << 2 | LISTED;
    if (first && item_index() == 0u) {
        words.at[LONGEST] = count < least ? 0u : longest;
    }
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint s = walkers.at[i];
        uvec2 ends = sub_constraints.at[s];
        uint known = lost.at[s];
        uint before = first ? NONE : firsts.at[s];
        bool at_hub = (known & AT_HUB) != 0u;
        bool reversed = degrees.at[ends.y] < degrees.at[ends.x];
        if (first) {
            bool hub = is_hub(ends.x);
            at_hub = hub || is_hub(ends.y);
            if (at_hub) {
                reversed = !hub;
                atomicOr(lost.at[s], AT_HUB);
                words.at[HUBS] = 1u;
            }
        } else if (at_hub) {
            reversed = (before & REVERSED) != 0u;
        }
        uint from = reversed ? ends.y : ends.x;
        uint to = reversed ? ends.x : ends.y;
        uint spoke = first || !at_hub ? spokes.at[from] : spoke_near(before & HALF_EDGE, from);
        Walker walker = turn_from(spoke, point_at(positions, from), point_at(positions, to));
        uint event = TURNS;
        bool backward = !first && at_hub;
        for (uint step = 0u; step <= 2u * most && event == TURNS; step++) {
            event = advance(walker, triangles, ReadRows(links), positions);
            // First backward, until the line does not lie right of the spoke.
            if (backward && event == TURNS) {
                backward = walker.right == 1;
                if (backward) {
                    walker = turn_from(rotate_cw(links, walker.h), walker.a, walker.b);
                } else {
                    walker.start = walker.h;
                }
            }
        }
        uint h = walker.h;
        if (event == LEAVES) {
            if (at_hub) {
                uint edge = h % 3u;
                uint mine = scatter(s, OWNER_BITS) << 4;
                uint word = mine | (reversed ? NO_EDGE << 2 | edge : edge << 2 | NO_EDGE);
                uint old = atomicMin(state.at[OWNED(h / 3u)], word);
                settle_claim(state, lost, words, s, word, old, h / 3u, stamp, false, true);
            }
            firsts.at[s] = h | (reversed ? REVERSED : 0u);
            if (!reversed && !at_hub) {
                atomicOr(lost.at[s], h / 3u << LOW_SHIFT);
            }
        } else {
            firsts.at[s] = NONE;
            if (event == ALONG && destination(triangles, h) == to) {
                uint g = twin(links, h);
                set_link(links, h, g | CONSTRAINED);
                set_link(links, g, h | CONSTRAINED);
                atomicOr(lost.at[s], BARRED);
                atomicAdd(words.at[INSERTED], 1u);
            } else {
                atomicMin(words.at[DEPART_FAULT], s << 2 | (event == ALONG ? THROUGH_VERTEX : ASTRAY));
            }
        }
    }
}
