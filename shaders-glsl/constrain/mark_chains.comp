// Steps 2 and 3 of an outer round: walkers claim each triangle that they cross; the least word says who owns it. Who finds a
// lower word, or has its own replaced, does not own its whole chain.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadPoints positions;
    ReadU32x2 sub_constraints;
    ReadU32x2 walkers; // of even rounds, then of odd ones
    U32 lost;
    U32 owner;
    WriteU32 state; // of which the stamps say who got its owner in this round
    WriteU32 marked;
    U32 words;
    uint stride;
    uint limit; // sub-constraints that there is room for
    uint most;  // triangles that any walk takes
};

shared uint walked;

void lose(uint s) {
    if (atomicExchange(lost.at[s], 1u) == 0u) {
        atomicAdd(words.at[LOSERS], 1u);
    }
}

void own(uint s, uint word, uint t, uint stamp) {
    uint old = atomicMin(owner.at[t], word);
    if (old == FREE) {
        state.at[2u * stride + t] = stamp;
        marked.at[atomicAdd(words.at[MARKED], 1u)] = t;
    } else if (!same_owner(old, word)) {
        lose(old < word ? s : owner_of(old));
    }
}

void main() {
    uint into = words.at[OUTER] & 1u ^ 1u;
    uint end = words.at[DEPART_FAULT] == NONE ? words.at[WALKERS + into] : 0u;
    uint stamp = words.at[ROUND] << 2 | LISTED;
    if (gl_LocalInvocationIndex == 0u) {
        walked = 0u;
    }
    barrier();
    uint steps = 0u;
    for (uint i = item_index(); i < end; i += item_stride()) {
        uvec2 entry = walkers.at[into * limit + i];
        uint s = entry.x;
        uint h = entry.y;
        uvec2 ends = sub_constraints.at[s];
        // Words are those of the direction from the lower end to the higher one.
        bool reversed = apex(triangles, h) == ends.y;
        ends = reversed ? ends.yx : ends;
        Point a = point_at(positions, ends.x);
        Point b = point_at(positions, ends.y);
        uint mine = scatter(s, OWNER_BITS) << 4;
        uint entered = NO_EDGE;
        uint fault = ASTRAY;
        for (uint step = 0u; step < most; step++) {
            uint g = links.at[h];
            if ((g & CONSTRAINED) != 0u) {
                fault = g == NONE ? ASTRAY : BLOCKED;
                break;
            }
            uint edge = h % 3u;
            own(s, mine | (reversed ? entered << 2 | edge : edge << 2 | entered), h / 3u, stamp);
            steps++;
            entered = g % 3u;
            uint w = apex(triangles, g);
            if (w >= DELETED) {
                break;
            }
            int side = orient2d(a, b, point_at(positions, w));
            if (side == 0) {
                own(s, mine | (reversed ? entered << 2 | NO_EDGE : NO_EDGE << 2 | entered), g / 3u, stamp);
                steps++;
                fault = w == ends.y ? NONE : THROUGH_VERTEX;
                break;
            }
            h = side > 0 ? next_edge(g) : prev_edge(g);
        }
        if (fault != NONE) {
            atomicMin(words.at[WALK_FAULT], s << 2 | fault);
        }
    }
    atomicAdd(walked, steps);
    barrier();
    if (gl_LocalInvocationIndex == 0u && walked != 0u) {
        add_wide(words, WALKED, walked);
    }
}
