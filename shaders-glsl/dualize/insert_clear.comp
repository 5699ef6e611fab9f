// Insertion into a mesh that fell behind, before all of it is tested: the slots of points that wait are free. Until then nobody
// has looked at them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadU32x2 waiting;
    ReadU32x2 freed;
    ReadU32 words;
    uint limit;
};

void main() {
    uint i = item_index();
    if (i < words.at[WAITING]) {
        uvec2 own = slots_of(waiting.at[words.at[PARITY] * limit + i].x, freed, words);
        free_slot(triangles, links, own.x);
        free_slot(triangles, links, own.y);
    }
}
