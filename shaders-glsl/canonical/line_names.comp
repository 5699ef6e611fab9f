// Each point of a run of equal keys is represented by the first of the run, the lowest.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 values;
    ReadU32 flags;
    ReadU32 ranks; // runs that begin before
    ReadU32 heads;
    WriteU32 representatives;
    uint count;
};

void main() {
    uint p = item_index();
    if (p < count) {
        representatives.at[values.at[p]] = heads.at[ranks.at[p] + flags.at[p] - 1u];
    }
}
