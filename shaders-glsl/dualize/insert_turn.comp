// Insertion, the end of a round: a hull that is not closed by now ends it all.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 reflex; // edges of the hull that are still reflex
    U32 words;
};

void main() {
    if (item_index() == 0u && reflex.at[0] != 0u) {
        words.at[OPEN_HULL] = 1u;
        words.at[WAITING] = 0u;
        for (uint k = 0u; k < 3u; k++) {
            words.at[GROUPS + k] = 0u;
        }
    }
}
