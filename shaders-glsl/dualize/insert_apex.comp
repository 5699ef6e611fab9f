// Insertion, before the rounds, 3 of 5: where no triangle is finite, the least priority of the points that lie off the line
// through the first and last vertex.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    U32 words;
    uint count;
};

void main() {
    uvec2 ends = uvec2(words.at[ENDS], words.at[ENDS + 1u]);
    if (words.at[CENTER_SLOT] != NONE || ends.x == NONE) {
        return;
    }
    Point a = point_at(positions, ends.x);
    Point b = point_at(positions, ends.y);
    for (uint v = item_index(); v < count; v += item_stride()) {
        uint mine = priority(v);
        // What has been read may be old, but never less than what is there.
        if (mine < words.at[APEX] && orient2d(a, b, point_at(positions, v)) != 0) {
            atomicMin(words.at[APEX], mine);
        }
    }
}
