// Of all points that are equal to a vertex the lowest input index names it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 vertex_of;
    ReadU32 order;
    U32 names;
    uint count;
};

void main() {
    uint i = item_index();
    if (i >= count) {
        return;
    }
    uint v = vertex_of.at[i];
    if (v != i && v < count) {
        atomicMin(names.at[v], order.at[i]);
    }
}
