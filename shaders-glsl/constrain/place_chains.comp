// Puts the ends of the constraints, and the vertices they met, where they belong in the chains; nothing if the walks were not
// whole.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "chains.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32x2 ends;
    ReadU32 met;
    ReadU32 offsets; // by constraint, and the end of the last one
    U32x4 pieces;
    ReadU32 before;  // by later piece: what those before it met
    ReadU32 stops;
    U32 words;
    WriteU32 chains;
    uint constraints;
    uint stop_limit;
};

void main() {
    bool whole = is_whole(ReadU32(words), stop_limit);
    uint i = item_index();
    if (i == 0u) {
        words.at[CHAINED] = whole ? offsets.at[constraints] : 0u;
        words.at[SUB_CONSTRAINTS] = whole ? offsets.at[constraints] - constraints : 0u;
    }
    if (!whole) {
        return;
    }
    if (i < constraints) {
        uvec2 both = ends.at[i];
        chains.at[offsets.at[i]] = both.x;
        if (both.x != both.y) {
            chains.at[offsets.at[i + 1u] - 1u] = both.y;
        }
    }
    for (uint s = i; s < words.at[STOPS]; s += item_stride()) {
        Stop stop = stop_at(s, ReadU32(words), stops, met, offsets, pieces, before, constraints);
        if (stop.place != NONE) {
            chains.at[stop.place] = stop.vertex;
        }
    }
}
