// Pin: tests all triangles, and pins the corners of every one that is not counterclockwise. Of ghost triangles, lists the
// edge that leads to the ghost.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadPoints positions;
    U32 state;
    U32 pinned;   // half-edges, each out of a pinned site
    U32 words;
    ReadU32 slots;
    U32 hull; // half-edges
    U32 hull_count;
    uint hull_limit;
    uint limit;
};

const uint AT_ONCE = 2u;

// Bad triangles are few, and pinning their corners takes long: they wait until all invocations have one.
shared uint bad[(AT_ONCE + 1u) * WORKGROUP];
shared uint bad_count;

void pin_corners(uint t) {
    uvec3 at = corners(triangles, t);
    bool is_new[3];
    [[unroll]] for (uint k = 0u; k < 3u; k++) {
        is_new[k] = pin(state, at[k]);
    }
    uint place = reserve(words, PIN_COUNTS, uint(is_new[0]) + uint(is_new[1]) + uint(is_new[2]));
    [[unroll]] for (uint k = 0u; k < 3u; k++) {
        if (is_new[k]) {
            pinned.at[place] = prev_edge(3u * t + k);
            state.at[at[k]] = PINNED | place;
            place++;
        }
    }
}

void list_hull_edge(uint t, uvec3 at) {
    uint place = append(hull_count, 0u);
    if (place < hull_limit) {
        // The edge whose destination is the ghost: the one after that opposite to it.
        hull.at[place] = next_edge(3u * t + (at.x == GHOST ? 0u : at.y == GHOST ? 1u : 2u));
    }
}

void main() {
    uint count = min(slots.at[0], limit);
    if (gl_LocalInvocationIndex == 0u) {
        bad_count = 0u;
    }
    barrier();
    uint stride = item_stride();
    for (uint base = gl_WorkGroupID.x * WORKGROUP; base < count; base += AT_ONCE * stride) {
        uint t[AT_ONCE];
        uvec3 at[AT_ONCE];
        uvec4 where[AT_ONCE][3];
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            uint i = min(base + k * stride + gl_LocalInvocationIndex, count - 1u);
            t[k] = i;
            at[k] = corners(triangles, t[k]);
        }
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            if (base + k * stride + gl_LocalInvocationIndex >= count) {
                at[k] = uvec3(DELETED);
            }
            [[unroll]] for (uint j = 0u; j < 3u; j++) {
                where[k][j] = positions.at[at[k][j] < DELETED ? at[k][j] : 0u];
            }
        }
        [[dont_unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            uvec3 now = k == 0u ? at[0] : at[1];
            uint slot = k == 0u ? t[0] : t[1];
            if (any(greaterThanEqual(now, uvec3(DELETED)))) {
                if (now.x != DELETED) {
                    list_hull_edge(slot, now);
                }
                continue;
            }
            uvec4 a = k == 0u ? where[0][0] : where[1][0];
            uvec4 b = k == 0u ? where[0][1] : where[1][1];
            uvec4 c = k == 0u ? where[0][2] : where[1][2];
            if (orient2d(a, b, c) != 1) {
                bad[atomicAdd(bad_count, 1u)] = slot;
            }
        }
        barrier();
        uint waiting = bad_count;
        barrier();
        if (waiting >= WORKGROUP) {
            for (uint i = gl_LocalInvocationIndex; i < waiting; i += WORKGROUP) {
                pin_corners(bad[i]);
            }
            if (gl_LocalInvocationIndex == 0u) {
                bad_count = 0u;
            }
            barrier();
        }
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < bad_count; i += WORKGROUP) {
        pin_corners(bad[i]);
    }
}
