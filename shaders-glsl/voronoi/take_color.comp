// Recoloring, 2 of 2: all debris takes what it found at once. Where a pixel with debris around it changed, one more round
// is wanted: `again` is then the number of debris pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    U32 colors;
    ReadU32 state;
    ReadU32 debris;
    ReadU32 found;
    ReadU32 count;
    U32 again;
    uint width;
    uint height;
};

void main() {
    uint i = item_index();
    if (i >= count.at[0]) {
        return;
    }
    uint index = debris.at[i];
    uint color = found.at[i];
    if (colors.at[index] == color) {
        return;
    }
    colors.at[index] = color;
    uint pixel = pixel_at(index, width);
    bool any_debris = false;
    for (uint k = 0u; k < 8u; k++) {
        uint other = neighbor(pixel, k, width, height);
        any_debris = any_debris || (other != NONE && state.at[index_of(other, width)] != 0u);
    }
    if (any_debris) {
        atomicMax(again.at[0], count.at[0]);
    }
}
