// Step 3 of a round, first half: of all that claim a triangle the least priority gets it, and who got both is flipped.
// Outer links keep the names that they had before the round, until `relink_edges` renews them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "rounds.glsl"

layout(push_constant, std430) uniform Args {
    U32 triangles;
    U32 links;
    U32 claims;
    U32 stamps;
    U32 illegal;
    U32 edge_count;
    MaybeReadU32 edges; // whose bits are cleared
    MaybeU32 listed;
    U32 words;
    U32 report;
    uint limit;
};

shared uint flips_of_group;

void main() {
    uint end = min(words.at[ILLEGAL_COUNT], limit);
    uint taken = words.at[TAKEN_COUNT];
    uint round = words.at[ROUND];
    if (gl_LocalInvocationIndex == 0u) {
        flips_of_group = 0u;
    }
    barrier();
    uint flips = 0u;
    for (uint i = item_index(); i < end; i += item_stride()) {
        uint h = illegal.at[i];
        if (flip_if_won(triangles, links, claims, stamps, round, h)) {
            illegal.at[i] = h | WON;
            flips++;
        }
    }
    if (present(listed)) {
        for (uint i = item_index(); i < taken; i += item_stride()) {
            uint h = edges.at[i];
            if (h != NONE) {
                atomicAnd(listed.at[h >> 5], ~(1u << (h & 31u)));
            }
        }
    }
    if (flips != 0u) {
        atomicAdd(flips_of_group, flips);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && flips_of_group != 0u) {
        add_wide(report, REPORT_FLIPS, flips_of_group);
    }
    if (item_index() == 0u) {
        words.at[RELINK_COUNT] = end;
        words.at[DEFERRED_COUNT] = 0u;
        if (taken != 0u) {
            edge_count.at[0] = 0u;
            report.at[REPORT_ROUNDS] += 1u;
        }
    }
}
