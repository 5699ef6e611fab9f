// Who leaves a hub and did not get the triangle there has to wait: it would not get its whole chain.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "claims.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 walkers;
    ReadU32 firsts;
    U32 lost;
    U32 state;
    U32 words;
};

shared uint admitted;

void main() {
    uint count = words.at[DEPART_FAULT] == NONE ? words.at[WALKERS] : 0u;
    if (gl_LocalInvocationIndex == 0u) {
        admitted = 0u;
    }
    barrier();
    uint sum = 0u;
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint s = walkers.at[i];
        uint h = firsts.at[s];
        uint known = lost.at[s];
        if ((known & BARRED) != 0u) {
            continue;
        }
        if ((known & AT_HUB) != 0u && !same_owner(scatter(s, OWNER_BITS) << 4, state.at[OWNED((h & HALF_EDGE) / 3u)])) {
            atomicOr(lost.at[s], BARRED);
            lose(lost, words, s);
        } else {
            sum++;
        }
    }
    atomicAdd(admitted, sum);
    barrier();
    if (gl_LocalInvocationIndex == 0u && admitted != 0u) {
        atomicAdd(words.at[ADMITTED], admitted);
    }
}
