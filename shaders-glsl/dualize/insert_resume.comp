// Insertion into a mesh that fell behind, after some flips: if none are left to be made, a round follows, else it is left out.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pending; // illegal edges
    U32 words;
    uint groups; // of kernels that stride over their items
};

void main() {
    if (item_index() != 0u) {
        return;
    }
    uint points = pending.at[0] == 0u ? words.at[WAITING_BEHIND] : 0u;
    bool some = points != 0u;
    set_groups(words, GROUPS, groups_of(points));
    set_groups(words, WIDE_GROUPS, some ? uvec3(groups, 1u, 1u) : uvec3(0u));
    set_groups(words, ONE_GROUP, uvec3(uint(some)));
}
