// Steps 1 and 2 of the first round: each edge of the mesh is tested, one triangle an invocation, and illegal ones claim
// their two triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"
#include "appending.glsl"
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    U32 claims;
    WriteU32x2 illegal;
    U32 words;
    U32 report;
    ReadU32 slots;
    uint scope;
    uint parity;
};

shared uint tests_of_group;

void main() {
    uint t = item_index();
    if (gl_LocalInvocationIndex == 0u) {
        tests_of_group = 0u;
    }
    barrier();
    uint tests = 0u;
    uint found = 0u; // a bit for each half-edge
    uvec3 row = uvec3(NONE);
    if (t < slots.at[0]) {
        uvec3 corner = corners(triangles, t);
        bool wanted = scope == SCOPE_ALL || any(equal(corner, uvec3(GHOST)));
        if (wanted && corner.x != DELETED) {
            row = links_of(links, t);
            // What lies on the far sides, where this is the lower side of the edge; read ahead, all at once.
            uvec3 far = uvec3(GHOST);
            bvec3 lower;
            [[unroll]] for (uint k = 0u; k < 3u; k++) {
                uint h = 3u * t + k;
                bool is_ghost_edge = corner[(k + 1u) % 3u] == GHOST || corner[(k + 2u) % 3u] == GHOST;
                lower[k] = h < (row[k] & HALF_EDGE) && (scope == SCOPE_ALL || is_ghost_edge);
                tests += uint(lower[k]);
                lower[k] = lower[k] && (row[k] & CONSTRAINED) == 0u;
                if (lower[k]) {
                    far[k] = apex(triangles, row[k]);
                }
            }
            if (any(lower)) {
                // Each position is read once: reading is what takes the time.
                Point at[3] = Point[3](
                    corner_at(positions, corner.x), corner_at(positions, corner.y), corner_at(positions, corner.z)
                );
                [[dont_unroll]] for (uint k = 0u; k < 3u; k++) {
                    if (lower.x) {
                        Point beyond = corner_at(positions, far.x);
                        bool is = is_illegal(corner.x, corner.y, corner.z, far.x, at[0], at[1], at[2], beyond);
                        found |= uint(is) << k;
                    }
                    // Edge by edge comes to the front.
                    corner = corner.yzx;
                    far = far.yzx;
                    lower = lower.yzx;
                    Point front = at[0];
                    at[0] = at[1];
                    at[1] = at[2];
                    at[2] = front;
                }
            }
        }
    }
    if (tests != 0u) {
        atomicAdd(tests_of_group, tests);
    }
    uint total;
    uint before = sum_before(bitCount(found), total);
    if (gl_LocalInvocationIndex == 0u && total != 0u) {
        place_of_group = atomicAdd(words.at[ILLEGAL_COUNT(parity)], total);
    }
    barrier();
    uint place = place_of_group + before;
    [[unroll]] for (uint k = 0u; k < 3u; k++) {
        if ((found >> k & 1u) != 0u) {
            uint h = 3u * t + k;
            claim(claims, h, row[k]);
            illegal.at[place++] = uvec2(h, row[k]);
        }
    }
    if (gl_LocalInvocationIndex == 0u && tests_of_group != 0u) {
        add_wide(report, REPORT_TESTS, tests_of_group);
        if (words.at[ANY_TESTED] == 0u && atomicExchange(words.at[ANY_TESTED], 1u) == 0u) {
            atomicAdd(report.at[REPORT_ROUNDS], 1u);
        }
    }
}
