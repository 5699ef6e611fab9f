// Steps 1 and 2 of the first round: each edge of the mesh is tested, and illegal ones claim their two triangles. A workgroup
// reads some triangles, gathers the edges of which they are the lower side, and tests those densely.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "appending.glsl"
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadPoints positions;
    U32 state;
    WriteU32 illegal;
    U32 words;
    U32 report;
    ReadU32 slots;
    uint stride;
    uint scope;
    uint parity;
};

// Triangles of an invocation.
const uint EACH = 2u;
// The half-edges to be tested, and what lies on their far sides.
shared uint gathered[3u * EACH * WORKGROUP];
shared uint far[3u * EACH * WORKGROUP];
shared uint tests_of_group;

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint end = slots.at[0];
    if (rank == 0u) {
        tests_of_group = 0u;
    }
    barrier();
    uint tests = 0u;
    uint wanted = 0u; // a bit for each half-edge
    uint apexes[3u * EACH];
    [[unroll]] for (uint e = 0u; e < EACH; e++) {
        uint t = (group_index() * EACH + e) * WORKGROUP + rank;
        uvec3 corner = uvec3(DELETED);
        uvec3 row = uvec3(NONE);
        if (t < end) {
            corner = corners(triangles, t);
            row = uvec3(links.at[3u * t], links.at[3u * t + 1u], links.at[3u * t + 2u]);
        }
        [[unroll]] for (uint k = 0u; k < 3u; k++) {
            bool in_scope = scope == SCOPE_ALL || corner[(k + 1u) % 3u] == GHOST || corner[(k + 2u) % 3u] == GHOST;
            if (corner.x != DELETED && in_scope && 3u * t + k < (row[k] & HALF_EDGE)) {
                tests++;
                if ((row[k] & CONSTRAINED) == 0u) {
                    wanted |= 1u << (3u * e + k);
                    apexes[3u * e + k] = triangles.at[row[k]];
                }
            }
        }
    }
    uint total;
    uint place = sum_before(bitCount(wanted), total);
    [[unroll]] for (uint j = 0u; j < 3u * EACH; j++) {
        if ((wanted >> j & 1u) != 0u) {
            gathered[place] = 3u * ((group_index() * EACH + j / 3u) * WORKGROUP + rank) + j % 3u;
            far[place] = apexes[j];
            place++;
        }
    }
    if (tests != 0u) {
        atomicAdd(tests_of_group, tests);
    }
    barrier();
    // The same number of turns for the whole workgroup.
    for (uint begin = 0u; begin < total; begin += WORKGROUP) {
        bool illegal_edge = false;
        uint h = 0u;
        if (begin + rank < total) {
            h = gathered[begin + rank];
            uint a = apex(triangles, h);
            illegal_edge = is_illegal(positions, a, origin(triangles, h), destination(triangles, h), far[begin + rank]);
        }
        uint to = place_in(words, ILLEGAL_COUNT(parity), illegal_edge);
        if (illegal_edge) {
            claim(state, stride, parity, h, links.at[h]);
            illegal.at[to] = h;
        }
    }
    if (rank == 0u && tests_of_group != 0u) {
        add_wide(report, REPORT_TESTS, tests_of_group);
        if (words.at[ANY_TESTED] == 0u && atomicExchange(words.at[ANY_TESTED], 1u) == 0u) {
            atomicAdd(report.at[REPORT_ROUNDS], 1u);
        }
    }
}
