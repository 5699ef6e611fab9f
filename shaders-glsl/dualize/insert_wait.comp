// Insertion, before the rounds, 5 of 5: where the walk to each point starts, and the words of the first round.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "count.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadU32 half_edges;
    ReadU32 points;
    ReadU32 starts;
    MaybeReadU32 counter; // how many points; all without
    U32x2 waiting;
    WriteU32 slots;
    U32 words;
    uint limit;
    uint vertices;
};

void main() {
    uint count = length_of(counter, limit);
    uint slot = words.at[CENTER_SLOT];
    uint i = item_index();
    if (i < count && slot != NONE) {
        uint start = starts.at[i];
        uint from = start < vertices ? half_edges.at[start] : NONE;
        waiting.at[i] = uvec2(points.at[i], from == NONE ? 3u * slot : from);
    }
    if (i == 0u) {
        // Without a finite triangle there is nothing to walk through: no round has anything to do.
        uint first = slot == NONE ? 0u : count;
        set_groups(words, GROUPS, groups_of(first));
        for (uint k = 0u; k < 3u; k++) {
            words.at[CENTER + k] = slot == NONE ? 0u : apex(triangles, 3u * slot + k);
        }
        words.at[WAITING] = first;
        words.at[WAITING_STEADY] = first;
        words.at[WAITING_BEHIND] = 0u;
        words.at[SLOW] = 0u;
        words.at[NEXT] = 0u;
        words.at[PARITY] = 0u;
        words.at[ROUND] = 1u;
        words.at[FINISHED] = 0u;
        words.at[INSERTED] = 0u;
        words.at[DUPLICATES] = 0u;
        words.at[LOST] = NONE;
        // From now on all slots count, also those that wait for their points.
        if (slot != NONE) {
            slots.at[0] = 2u * vertices - 2u;
        }
    }
}
