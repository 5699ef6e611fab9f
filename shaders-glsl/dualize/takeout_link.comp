// Take out: links the outer edges of the stars that were cut to what is across, which may be an outer edge of another star;
// and tells pinned sites around them of a half-edge that they still have.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "takeout.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    U32 state;
    ReadU32 edge_of;
    OuterEdges edges;
    ReadU32 words;
    uint round; // of the batch
};

void main() {
    uint count = words.at[OUT_EDGES + round];
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint h = edges.at[i].y;
        uint across = link_of(links, h);
        uint entry = edge_of.at[across / 3u];
        if (entry < count && edges.at[entry].x == across / 3u) {
            set_link(links, h, edges.at[entry].y);
        } else {
            set_link(links, across, h);
        }
        uint v = origin(triangles, h);
        if (v != GHOST && (state.at[v] & PINNED) != 0u) {
            state.at[v] = PINNED | h;
        }
    }
}
