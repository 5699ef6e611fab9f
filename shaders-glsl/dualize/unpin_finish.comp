// Unpin: what has become of each pinned site. The list of their half-edges becomes a list of the sites, and those that are
// still pinned are to be taken out.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    U32 state;
    U32 all;
    U32 stuck;
    WriteU32 waits_for; // two words for each site: nobody, and no round
    U32 words;
};

void main() {
    uint count = words.at[BAD];
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint h = all.at[i];
        uint v = origin(triangles, h);
        bool is_free = (state.at[v] & FREED) != 0u;
        all.at[i] = v;
        state.at[v] = is_free ? v : PINNED | h;
        if (!is_free) {
            stuck.at[append(words, OUT_COUNTS)] = v;
            waits_for.at[2u * v] = NONE;
            waits_for.at[2u * v + 1u] = 0u;
        }
    }
}
