// The result: corners from the smallest on, the triangle across each edge (NONE at the hull), and for each triangle a byte
// whose bit k says that edge k is constrained (in words where zeros stood).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 triangles;
    ReadU32 links;
    ReadU32 names;
    ReadU32 list;
    ReadU32 keys;
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
    uint p = item_index();
    if (p >= length_of(counter, limit)) {
        return;
    }
    uint slots = min(slot_count.at[0], slot_limit);
    uint h = list.at[p];
    uint place = places.at[h / 3u];
    sorted.at[3u * place] = names.at[apex(triangles, h)];
    sorted.at[3u * place + 1u] = keys.at[p];
    sorted.at[3u * place + 2u] = names.at[destination(triangles, h)];
    uint marks = 0u;
    [[unroll]] for (uint j = 0u; j < 3u; j++) {
        uint other = twin(links, h) / 3u;
        neighbors.at[3u * place + j] = other < slots ? places.at[other] : NONE;
        marks |= is_constrained(links, h) ? 1u << j : 0u;
        h = next_edge(h);
    }
    if (marks != 0u) {
        atomicOr(constrained.at[place / 4u], marks << 8u * (place % 4u));
    }
}
