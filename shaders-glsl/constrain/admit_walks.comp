// Lists those that walk. Who leaves a hub and did not get the triangle there has to wait: it would not get its whole chain. These
// are by far the most where there are hubs, and no invocation shall idle for them on the walks.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "claims.glsl"
#include "appending.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 walkers;
    ReadU32 firsts;
    WriteU32 admitted;
    U32 lost;
    U32 state;
    U32 words;
};

void main() {
    uint count = has_failed(words) ? 0u : words.at[WALKERS];
    for (uint begin = group_index() * WORKGROUP; begin < count; begin += item_stride()) {
        uint i = begin + gl_LocalInvocationIndex;
        uint s;
        bool walks = false;
        if (i < count) {
            s = walkers.at[i];
            uint h = firsts.at[s];
            uint known = lost.at[s];
            walks = (known & BARRED) == 0u;
            if (walks && (known & AT_HUB) != 0u &&
                !same_owner(scatter(s, OWNER_BITS) << 4, state.at[OWNED((h & HALF_EDGE) / 3u)])) {
                walks = false;
                atomicOr(lost.at[s], BARRED);
                lose(lost, words, s);
            }
        }
        uint place = place_in(words, ADMITTED, walks);
        if (walks) {
            admitted.at[place] = s;
        }
    }
}
