// The list of each vertex: the half-edge opposite it in each triangle, and the name of the corner after it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadU32 names;
    ReadU32 places;
    ReadU32 starts;
    WriteU32 list;
    WriteU32 keys;
    MaybeReadU32 counter; // of slots
    uint limit;
};

void main() {
    uint t = item_index();
    if (t >= length_of(counter, limit)) {
        return;
    }
    uint place = places.at[t];
    if (place == NONE) {
        return;
    }
    uint h = 3u * t + (place & 3u);
    uint p = starts.at[apex(triangles, h)] + (place >> 2);
    list.at[p] = h;
    keys.at[p] = names.at[origin(triangles, h)];
}
