// Pin: tests triangles, all or those on a list, and pins the corners of every one that is not counterclockwise. Of ghost
// triangles, lists the edge that leads to the ghost.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadPoints positions;
    U32 state;
    U32 pinned;   // half-edges, each out of a pinned site
    U32 deferred; // triangles
    U32 words;
    MaybeReadU32 listed; // triangles
    ReadU32 slots;
    U32 hull; // half-edges
    U32 hull_count;
    uint hull_limit;
    uint limit;
    uint entry; // that newly pinned sites are counted in
};

void main() {
    bool all_slots = !present(listed);
    uint count = min(all_slots ? slots.at[0] : words.at[PIN_DEFERRED + entry], limit);
    uint before = pinned_before(words, entry);
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint t = all_slots ? i : listed.at[i];
        uvec3 at = corners(triangles, t);
        if (any(greaterThanEqual(at, uvec3(DELETED)))) {
            if (at.x != DELETED) {
                uint place = append(hull_count, 0u);
                if (place < hull_limit) {
                    // The edge whose destination is the ghost: the one after that opposite to it.
                    hull.at[place] = next_edge(3u * t + (at.x == GHOST ? 0u : at.y == GHOST ? 1u : 2u));
                }
            }
            continue;
        }
        int sign = orient2d(point_at(positions, at.x), point_at(positions, at.y), point_at(positions, at.z));
        if (sign == 1) {
            continue;
        }
        if (sign == UNDECIDED) {
            deferred.at[append(words, PIN_DEFERRED + entry)] = t;
            continue;
        }
        for (uint k = 0u; k < 3u; k++) {
            if (pin(state, at[k])) {
                uint place = before + append(words, PIN_COUNTS + entry);
                pinned.at[place] = prev_edge(3u * t + k);
                state.at[at[k]] = PINNED | place;
            }
        }
    }
}
