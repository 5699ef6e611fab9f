// Step 3 of a round, first half: of all that claim a triangle the least priority gets it, and who got both is flipped.
// Outer links keep the names that they had before the round, until they are renewed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    U32 claims;
    U32x2 illegal;
    MaybeReadU32 edges; // the list that was tested, to be emptied
    MaybeU32 edge_count;
    MaybeU32 listed; // whose bits are cleared
    U32 words;
    U32 report;
    uint limit; // edges that the list takes
    uint least; // fewer illegal edges are left to another kernel
    uint parity;
};

shared uint flips_of_group;

void main() {
    uint count = words.at[ILLEGAL_COUNT(parity)];
    uint end = count >= least ? count : 0u;
    uint round = words.at[ROUND] + 1u;
    if (gl_LocalInvocationIndex == 0u) {
        flips_of_group = 0u;
    }
    barrier();
    uint flips = 0u;
    for (uint i = item_index(); i < end; i += item_stride()) {
        uvec2 edge = illegal.at[i];
        if (flip_pair(triangles, links, claims, round, edge)) {
            illegal.at[i].x = edge.x | WON;
            flips++;
        }
    }
    if (flips != 0u) {
        atomicAdd(flips_of_group, flips);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && flips_of_group != 0u) {
        add_wide(report, REPORT_FLIPS, flips_of_group);
    }
    if (present(listed)) {
        uint listed_end = min(words.at[LISTED_COUNT], limit);
        for (uint i = item_index(); i < listed_end; i += item_stride()) {
            uint h = edges.at[i];
            if (h != NONE) {
                atomicAnd(listed.at[h >> 5], ~(1u << (h & 31u)));
            }
        }
    }
    if (item_index() == 0u) {
        words.at[TAKEN_COUNT] = end;
        words.at[ROUND_NOW] = round;
        words.at[ANY_TESTED] = 0u;
        if (present(edge_count)) {
            edge_count.at[0] = 0u;
        }
    }
}
