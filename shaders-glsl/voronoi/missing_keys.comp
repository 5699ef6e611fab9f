// Mapping, 4 of 5: what the missing points are sorted by, the index of their pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 pixels;
    ReadU32 missing;
    WriteU32 keys;
    MaybeReadU32 counter;
    uint limit;
    uint width;
};

void main() {
    uint i = item_index();
    if (i < length_of(counter, limit)) {
        keys.at[i] = index_of(pixels.at[missing.at[i]], width);
    }
}
