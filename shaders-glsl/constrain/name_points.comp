// Names, 1 of 2: for each point of the input the vertex that it is or equals.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "buffers.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 order;     // the point of the input by the number of the renumbering
    ReadU32 vertex_of; // the vertex by the same
    WriteU32 vertices; // the vertex by the point of the input
    uint count;
};

void main() {
    uint i = item_index();
    if (i < count) {
        vertices.at[order.at[i]] = vertex_of.at[i];
    }
}
