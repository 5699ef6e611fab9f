// How many triangles begin at each vertex, in the order of names (where zeros stood).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 starts;
    ReadU32 names;
    WriteU32 named_counts;
    uint count;
};

void main() {
    uint v = item_index();
    if (v >= count) {
        return;
    }
    uint found = starts.at[v + 1u] - starts.at[v];
    if (found != 0u) {
        named_counts.at[names.at[v]] = found;
    }
}
