// The end of a round and the beginning of the next in one: renews the links around all flips, gives claimed triangles back,
// and tests the edges that are handed on, which claim their triangles for the next round. An illegal edge next to no flip
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
    U32 state;
    ReadU32 illegal; // of this round
    WriteU32 next_illegal;
    U32 words;
    U32 report;
    uint stride;
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
            uint h = illegal.at[i >> 2];
            uint k = i & 3u;
            if ((h & WON) != 0u) {
                h &= HALF_EDGE;
                uint g = prev_edge(link_of(links, next_edge(h)));
                if (k < 2u) {
                    state.at[CLAIM(k == 0u ? h : g, parity)] = NONE;
                }
                handed = renew(links, state, stride, round, side_of(h, g, k));
                if (handed.some) {
                    uint b = origin(triangles, handed.side);
                    uint c = destination(triangles, handed.side);
                    if (scope == SCOPE_ALL || b == GHOST || c == GHOST) {
                        tests++;
                        if (handed.mark == 0u) {
                            uint a = apex(triangles, handed.side);
                            illegal_edge = is_illegal(positions, a, b, c, apex(triangles, handed.outer));
                        }
                    }
                }
            } else if (k == 0u) {
                handed = leave(links, state, stride, parity, round, h);
                illegal_edge = handed.some;
                tests += uint(handed.some);
            }
        }
        uint lower = min(handed.side, handed.outer);
        uint place = place_in(words, ILLEGAL_COUNT(parity ^ 1u), illegal_edge);
        if (illegal_edge) {
            claim(state, stride, parity ^ 1u, lower, max(handed.side, handed.outer));
            next_illegal.at[place] = lower;
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
