// Insertion, before the rounds, 4 of 5: a chain of vertices and one point off its line become a triangulation. The ghost
// triangles on that side get the point as their corner in place of the ghost vertex, and at both ends of the chain a new
// ghost triangle goes in between.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32 slots;
    ReadU32x2 freed;
    U32 words;
};

// The point of a priority.
uint of_priority(uint priority) {
    uint x = priority;
    x ^= x >> 16;
    x *= 0x43021123u;
    x ^= x >> 15 ^ x >> 30;
    x *= 0x1d69e2a5u;
    return x ^ (x >> 16);
}

void put(uint t, uvec3 corner) {
    set_corners(triangles, t, corner.x, corner.y, corner.z);
    note_of(links, t) = NONE;
}

void join(uint t, uint apex_point, uvec2 own) {
    uvec3 corner = corners(triangles, t);
    uint k = corner.x == GHOST ? 0u : corner.y == GHOST ? 1u : 2u;
    if (corner[k] != GHOST) {
        return;
    }
    uint w = corner[(k + 1u) % 3u];
    uint u = corner[(k + 2u) % 3u];
    if (orient2d(point_at(positions, w), point_at(positions, u), point_at(positions, apex_point)) <= 0) {
        return;
    }
    uint h = 3u * t + k;
    uint to_u = next_edge(h);
    uint to_w = prev_edge(h);
    uint behind = twin(links, to_u);
    uint ahead = twin(links, to_w);
    set_apex(triangles, h, apex_point);
    // Where the ring of ghost triangles turns back, the next one is that of the same edge, seen from behind.
    if (apex(triangles, behind) == w) {
        put(own.x, uvec3(apex_point, u, GHOST));
        link(links, 3u * own.x, behind);
        link(links, 3u * own.x + 2u, to_u);
    }
    if (apex(triangles, ahead) == u) {
        put(own.y, uvec3(w, apex_point, GHOST));
        link(links, 3u * own.y + 1u, ahead);
        link(links, 3u * own.y + 2u, to_w);
    }
    atomicMin(words.at[CENTER_SLOT], t);
}

void main() {
    uint least = words.at[APEX];
    if (least == NONE) {
        return;
    }
    uint apex_point = of_priority(least);
    uvec2 own = slots_of(apex_point, freed, ReadU32(words));
    uint i = item_index();
    if (i == 0u) {
        link(links, 3u * own.x + 1u, 3u * own.y);
    }
    if (words.at[CHAIN] != 0u) {
        for (uint t = i; t < slots.at[0]; t += item_stride()) {
            if (t != own.x && t != own.y && !is_deleted(triangles, t)) {
                join(t, apex_point, own);
            }
        }
    } else if (i < 2u) {
        uint keeps = words.at[ENDS] == 0u ? words.at[ENDS + 1u] : words.at[ENDS];
        join(2u * keeps - 2u + i, apex_point, own);
    }
}
