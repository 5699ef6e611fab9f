// Steps 1 and 2 of the first round: each edge of the mesh is tested, one triangle an invocation, and illegal ones claim
// their two triangles. What the filter leaves open is deferred to `test_edges` with exact arithmetic.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "found.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadPoints positions;
    U32 claims;
    WriteU32 illegal;
    WriteU32 deferred;
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
    uint found[3] = uint[3](LEGAL, LEGAL, LEGAL);
    uvec3 row = uvec3(NONE);
    if (t < slots.at[0]) {
        uvec3 corner = corners(triangles, t);
        bool wanted = scope == SCOPE_ALL || any(equal(corner, uvec3(GHOST)));
        if (wanted && corner.x != DELETED) {
            row = uvec3(links.at[3u * t], links.at[3u * t + 1u], links.at[3u * t + 2u]);
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
                    far[k] = triangles.at[row[k]];
                }
            }
            [[dont_unroll]] for (uint k = 0u; k < 3u; k++) {
                uint verdict_of_edge = LEGAL;
                if (lower.x) {
                    verdict_of_edge = verdict(positions, corner.x, corner.y, corner.z, far.x);
                }
                // Edge by edge comes to the front.
                corner = corner.yzx;
                far = far.yzx;
                lower = lower.yzx;
                found[0] = found[1];
                found[1] = found[2];
                found[2] = verdict_of_edge;
            }
        }
    }
    if (tests != 0u) {
        atomicAdd(tests_of_group, tests);
    }
    uint illegal_found = uint(found[0] == ILLEGAL) + uint(found[1] == ILLEGAL) + uint(found[2] == ILLEGAL);
    uint open_found = uint(found[0] == OPEN) + uint(found[1] == OPEN) + uint(found[2] == OPEN);
    uvec2 place = places_for(words, parity, illegal_found, open_found);
    [[unroll]] for (uint k = 0u; k < 3u; k++) {
        uint h = 3u * t + k;
        if (found[k] == ILLEGAL) {
            claim(claims, h, row[k]);
            illegal.at[place.x++] = h;
        } else if (found[k] == OPEN) {
            deferred.at[place.y++] = h;
        }
    }
    if (gl_LocalInvocationIndex == 0u && tests_of_group != 0u) {
        add_wide(report, REPORT_TESTS, tests_of_group);
        if (words.at[ANY_TESTED] == 0u && atomicExchange(words.at[ANY_TESTED], 1u) == 0u) {
            atomicAdd(report.at[REPORT_ROUNDS], 1u);
        }
    }
}
