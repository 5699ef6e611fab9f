// The sub-constraints: from each vertex of a chain to the next, the lower one first. A chain has one fewer than vertices.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "chains.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 met;
    ReadU32 offsets;
    U32x4 pieces;
    ReadU32 before;
    ReadU32 stops;
    ReadU32 words;
    ReadU32 chains;
    WriteU32x2 sub_constraints;
    uint constraints;
    uint stop_limit;
};

void list(uint c, uint place) {
    uvec2 pair = uvec2(chains.at[place], chains.at[place + 1u]);
    sub_constraints.at[place - c] = uvec2(min(pair.x, pair.y), max(pair.x, pair.y));
}

void main() {
    if (!is_whole(words, stop_limit)) {
        return;
    }
    uint i = item_index();
    if (i < constraints && offsets.at[i] + 1u < offsets.at[i + 1u]) {
        list(i, offsets.at[i]);
    }
    for (uint s = i; s < words.at[STOPS]; s += item_stride()) {
        Stop stop = stop_at(s, words, stops, met, offsets, pieces, before, constraints);
        if (stop.place != NONE) {
            list(stop.constraint, stop.place);
        }
    }
}
