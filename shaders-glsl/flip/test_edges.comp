// Steps 1 and 2 of a round: each active edge is tested, and illegal ones claim their two triangles. What the filter leaves
// open is deferred to the same kernel with exact arithmetic, which runs over it next.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "verdict.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    U32 triangles;
    U32 links;
    ReadPoints positions;
    MaybeU32 edges; // all half-edges, if left out
    MaybeReadU32 edge_count;
    MaybeU32 listed; // a bit for each half-edge; where edges may repeat
    U32 claims;
    WriteU32 illegal;
    WriteU32 deferred;
    U32 words;
    U32 report;
    ReadU32 slots;
    uint limit; // edges that the lists take
    uint least; // fewer active edges are left to another kernel
    uint scope;
    uint again; // whether the edges are those that were deferred
};

shared uint tests_of_group;
shared uvec2 places;

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
    bool is_first = item_index() == 0u;
    uint count;
    if (again != 0u) {
        count = min(words.at[DEFERRED_COUNT], limit);
    } else if (present(edges)) {
        count = min(edge_count.at[0], limit);
        count = count >= least ? count : 0u;
        if (is_first) {
            words.at[TAKEN_COUNT] = count;
        }
    } else {
        count = 3u * slots.at[0];
    }
    if (is_first && again == 0u) {
        words.at[ROUND] += 1u;
    }
    if (gl_LocalInvocationIndex == 0u) {
        tests_of_group = 0u;
    }
    barrier();
    uint tests = 0u;
    // The same number of turns for the whole workgroup.
    for (uint begin = group_index() * WORKGROUP; begin < count; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        uint found = LEGAL;
        uint h = i;
        if (i < count) {
            bool wanted = true;
            if (present(edges)) {
                h = edges.at[i];
                wanted = !present(listed) || take(i, h);
            } else {
                uint g = links.at[h];
                wanted = g != NONE && h < (g & HALF_EDGE);
            }
            wanted = wanted && (scope == SCOPE_ALL || is_ghost_edge(triangles, h));
            if (wanted) {
                tests++;
                found = verdict(triangles, links, positions, h);
            }
        }
        uint total;
        uint before = sum_before(uint(found == ILLEGAL) | uint(found == OPEN) << 16, total);
        if (total == 0u) {
            continue;
        }
        if (gl_LocalInvocationIndex == 0u) {
            uint some = total & 0xffffu;
            places.x = some == 0u ? 0u : atomicAdd(words.at[ILLEGAL_COUNT], some);
            some = total >> 16;
            places.y = some == 0u ? 0u : atomicAdd(words.at[DEFERRED_COUNT], some);
        }
        barrier();
        if (found == ILLEGAL) {
            claim(claims, h, twin(links, h));
            illegal.at[places.x + (before & 0xffffu)] = h;
        } else if (found == OPEN) {
            deferred.at[places.y + (before >> 16)] = h;
        }
    }
    if (tests != 0u) {
        atomicAdd(tests_of_group, tests);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && tests_of_group != 0u && again == 0u) {
        add_wide(report, REPORT_TESTS, tests_of_group);
        if (!present(edges)) {
            words.at[TAKEN_COUNT] = count;
        }
    }
}
