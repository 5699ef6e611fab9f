// Steps 1 and 2 of a round over a list: each edge is tested, and illegal ones claim their two triangles. Where edges may
// repeat, and triangles may be free, `listed` sees to it that each is tested once.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"
#include "appending.glsl"
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    U32 edges;
    ReadU32 edge_count;
    MaybeU32 listed; // a bit for each half-edge, all zero; without, no edge is twice on the list
    U32 claims;
    WriteU32x2 illegal;
    U32 words;
    U32 report;
    uint limit; // edges that the list takes
    uint scope;
    uint parity;
};

shared uint tests_of_group;

// Whether the half-edge at this place of the list is to be tested; of repeated ones, one is. The place then holds the lower
// half-edge of the edge, or NONE.
bool take(uint i, inout uint h) {
    if (is_deleted(triangles, h / 3u)) {
        edges.at[i] = NONE;
        return false;
    }
    h = min(h, twin(links, h));
    uint bit = 1u << (h & 31u);
    bool first = (atomicOr(listed.at[h >> 5], bit) & bit) == 0u;
    edges.at[i] = first ? h : NONE;
    return first;
}

void main() {
    uint count = min(edge_count.at[0], limit);
    if (gl_LocalInvocationIndex == 0u) {
        tests_of_group = 0u;
        if (item_index() == 0u) {
            words.at[LISTED_COUNT] = count;
            report.at[REPORT_ROUNDS] += uint(count != 0u);
        }
    }
    barrier();
    uint tests = 0u;
    // The same number of turns for the whole workgroup.
    for (uint begin = group_index() * WORKGROUP; begin < count; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        bool illegal_edge = false;
        uint h = 0u;
        uint g = 0u;
        if (i < count) {
            h = edges.at[i];
            if (!present(listed) || take(i, h)) {
                g = link_of(links, h);
                if ((g & HALF_EDGE) < h) {
                    // The lower side comes first.
                    uint mark = g & CONSTRAINED;
                    g &= HALF_EDGE;
                    uint lower = g;
                    g = h | mark;
                    h = lower;
                }
                uint t = h / 3u;
                uint at = h - 3u * t;
                uvec4 row = FOUR_WORDS(triangles)[2u * t].row;
                uint b = pick(row, turned(at, 1u));
                uint c = pick(row, turned(at, 2u));
                if (scope == SCOPE_ALL || b == GHOST || c == GHOST) {
                    tests++;
                    if ((g & CONSTRAINED) == 0u) {
                        illegal_edge = is_illegal(positions, pick(row, at), b, c, apex(triangles, g));
                    }
                }
            }
        }
        uint place = place_in(words, ILLEGAL_COUNT(parity), illegal_edge);
        if (illegal_edge) {
            claim(claims, h, g);
            illegal.at[place] = uvec2(h, g);
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
