// Insertion, the end of a round: whether the mesh falls behind, so that flips have to be made before the next one. A hull that
// is not closed by now ends it all.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 reflex; // edges of the hull that are still reflex
    U32 words;
    uint slots;
};

// `reference::kernels::insert::insert_turn` word for word.
uint slow_rounds(uint before, uint edges, uint illegal, uint waiting, uint inserted) {
    bool telling = edges >= 256u && edges >= waiting / 32u && waiting >= inserted / 2u;
    return telling && illegal >= edges / 16u && illegal < edges / 2u - edges / 128u ? before + 1u : 0u;
}

void main() {
    if (item_index() != 0u) {
        return;
    }
    uint waiting = words.at[WAITING];
    bool behind = words.at[SLOW] >= SLOW_ROUNDS;
    // Where flips were made instead, what is left of them is no matter of the hull.
    if (reflex.at[0] != 0u && (!behind || words.at[WIDE_GROUPS] != 0u)) {
        words.at[OPEN_HULL] = 1u;
        waiting = 0u;
        words.at[WAITING] = 0u;
        set_groups(words, GROUPS, uvec3(0u));
    } else if (!behind) {
        uint slow = slow_rounds(words.at[SLOW], words.at[TESTED], words.at[ILLEGAL], waiting, words.at[INSERTED]);
        words.at[SLOW] = slow;
        behind = slow >= SLOW_ROUNDS;
        if (behind) {
            set_groups(words, GROUPS, uvec3(0u));
            set_groups(words, MESH_GROUPS, groups_of(slots));
        }
    }
    words.at[WAITING_STEADY] = behind ? 0u : waiting;
    words.at[WAITING_BEHIND] = behind ? waiting : 0u;
}
