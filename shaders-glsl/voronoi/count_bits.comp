// Mapping, 2 of 7 and 5 of 7: how many bits each word has, to be summed up.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 words;
    WriteU32 counts;
    uint count;
};

void main() {
    uint word = item_index();
    if (word < count) {
        counts.at[word] = uint(bitCount(words.at[word]));
    }
}
