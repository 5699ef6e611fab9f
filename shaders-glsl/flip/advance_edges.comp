// The end of a round and the beginning of the next in one: renews the links around all flips, and
// tests the edges that are handed on, which claim their triangles for the next round. An illegal edge next to no flip
// is known to be illegal.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"
#include "appending.glsl"
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadPoints positions;
    U32 claims;
    ReadU32x2 illegal; // of this round
    WriteU32x2 next_illegal;
    U32 words;
    U32 report;
    uint scope;
    uint parity; // of this round
};

shared uint tests_of_group;

void main() {
    uint taken = words.at[TAKEN_COUNT];
    uint end = 4u * taken;
    uint round = words.at[ROUND_NOW];
    if (item_index() == 0u) {
        words.at[ROUND] = round;
        if (taken != 0u) {
            words.at[ILLEGAL_COUNT(parity)] = 0u;
            report.at[REPORT_ROUNDS] += 1u;
        }
    }
    if (gl_LocalInvocationIndex == 0u) {
        tests_of_group = 0u;
    }
    barrier();
    uint tests = 0u;
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        bool illegal_edge = false;
        Handed handed;
        handed.some = false;
        if (i < end) {
            uvec2 edge = illegal.at[i >> 2];
            uint k = i & 3u;
            if ((edge.x & WON) != 0u) {
                edge.x &= HALF_EDGE;
                uint side = side_of(edge, k);
                uint t = side / 3u;
                uint at = side - 3u * t;
                uvec4 row = FOUR_WORDS(triangles)[2u * t].row;
                handed = look_out(links, round, side);
                uint d = apex(triangles, handed.outer);
                renew(links, handed);
                uint b = pick(row, turned(at, 1u));
                uint c = pick(row, turned(at, 2u));
                if (handed.some && (scope == SCOPE_ALL || b == GHOST || c == GHOST)) {
                    tests++;
                    if (handed.mark == 0u) {
                        illegal_edge = is_illegal(positions, pick(row, at), b, c, d);
                    }
                }
            } else if (k == 0u) {
                handed = leave(links, round, edge);
                illegal_edge = handed.some;
                tests += uint(handed.some);
            }
        }
        uvec2 next = uvec2(min(handed.side, handed.outer), max(handed.side, handed.outer));
        uint place = place_in(words, ILLEGAL_COUNT(parity ^ 1u), illegal_edge);
        if (illegal_edge) {
            claim(claims, next.x, next.y);
            next_illegal.at[place] = next;
        }
    }
    if (tests != 0u) {
        atomicAdd(tests_of_group, tests);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && tests_of_group != 0u) {
        add_wide(report, REPORT_TESTS, tests_of_group);
    }
}
