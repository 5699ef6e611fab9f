// For each point of a line how many different points lie before it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 values;
    ReadU32 flags;
    ReadU32 ranks; // runs that begin before
    WriteU32 places;
    uint count;
};

void main() {
    uint p = item_index();
    if (p < count) {
        places.at[values.at[p]] = ranks.at[p] + flags.at[p] - 1u;
    }
}
