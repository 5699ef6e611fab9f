// The result: corners from the smallest on, the triangle across each edge (NONE at the hull), and for each triangle a byte
// whose bit k says that edge k is constrained (in words where zeros stood). One invocation a corner, so that what goes to
// one place goes together: memory takes so many pieces a second, however short they are.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadU32 names;
    ReadU32 list;
    ReadU32 places;
    WriteU32 sorted;
    WriteU32 neighbors;
    U32 constrained;
    MaybeReadU32 counter; // of triangles
    uint limit;
    ReadU32 slot_count;
    uint slot_limit;
};

void main() {
    uint i = item_index();
    uint p = i / 3u;
    if (p >= length_of(counter, limit)) {
        return;
    }
    uint j = i - 3u * p;
    uint h = list.at[p];
    uint t = h / 3u;
    uint k = h - 3u * t + j;
    h = 3u * t + (k < 3u ? k : k - 3u);
    uint place = places.at[t];
    uint other = twin(links, h) / 3u;
    sorted.at[3u * place + j] = names.at[apex(triangles, h)];
    neighbors.at[3u * place + j] = other < min(slot_count.at[0], slot_limit) ? places.at[other] : NONE;
    if (is_constrained(links, h)) {
        atomicOr(constrained.at[place / 4u], 1u << (8u * (place % 4u) + j));
    }
}
