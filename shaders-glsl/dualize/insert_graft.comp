// Insertion, 3 of 4 of a round: points that got all they claimed split it, the others go on the next list.
//
// Links between the parts are new; outer edges keep the name of the other side that it had before, until `insert_relink`
// renews it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    U32x2 waiting;
    ReadU32x2 freed;
    U32 places;
    U32 claims;
    U32 words;
    uint limit;
};

shared uint base_of_group;

// The note of a triangle that was split.
uint split_at(uint edge) {
    return SPLIT | words.at[ROUND] << 2 | edge;
}

// Into the triangle t: slot t has a, b, p after, s has b, c, p and u has c, a, p.
void split_triangle(uint t, uint p, uint s, uint u) {
    uvec3 corner = corners(triangles, t);
    uvec3 outer = links_of(links, t);
    set_corners(triangles, t, corner.x, corner.y, p);
    set_links_noted(links, t, 3u * s + 1u, 3u * u, outer.z, split_at(3u));
    set_corners(triangles, s, corner.y, corner.z, p);
    set_links(links, s, 3u * u + 1u, 3u * t, outer.x);
    set_corners(triangles, u, corner.z, corner.x, p);
    set_links(links, u, 3u * t + 1u, 3u * s, outer.y);
}

// One side of an edge: `side` leads to p after, and its other side is in the slot u; the slot s has its apex, p and its end,
// and is linked to the other side of before.
void split_side(uint side, uint across, uint p, uint s, uint u) {
    uint outer = twin(links, next_edge(side));
    set_corners(triangles, s, apex(triangles, side), p, destination(triangles, side));
    set_links(links, s, across, outer, next_edge(side));
    set_apex(triangles, prev_edge(side), p);
    set_link(links, side, 3u * u);
    set_link(links, next_edge(side), 3u * s + 2u);
    note_of(links, side / 3u) = split_at(side % 3u);
}

void main() {
    uint i = item_index();
    uint place = i < words.at[WAITING] ? places.at[2u * i] : NONE;
    uint list = words.at[PARITY] * limit;
    bool won = false;
    bool lost = false;
    uint point = 0u;
    uint h = place & PLACE;
    if (place != NONE) {
        point = waiting.at[list + i].x;
        // Nobody else has this number, and nobody without the least score has set it.
        uint mine = precedence(point);
        won = claims.at[CLAIM * (h / 3u) + FIRST] == mine;
        if ((place & ON_EDGE) != 0u) {
            won = won && claims.at[CLAIM * places.at[2u * i + 1u] + FIRST] == mine;
        }
        lost = !won;
    }
    // Losers in the lower half of a word, winners in the upper one. Adding is up to one invocation of the workgroup: where
    // nearly all points lose, all of them add to the same word.
    uint total;
    uint before = sum_before(uint(lost) | uint(won) << 16, total) & 0xffffu;
    if (gl_LocalInvocationIndex == 0u) {
        uint losers = total & 0xffffu;
        uint winners = total >> 16;
        base_of_group = losers > 0u ? atomicAdd(words.at[NEXT], losers) : 0u;
        if (winners > 0u) {
            atomicAdd(words.at[INSERTED], winners);
        }
    }
    barrier();
    if (lost) {
        // The slot still has a triangle next to the point, with the new vertex, which has few neighbors, at corner 2.
        uint from = (place & ON_EDGE) == 0u ? h + 1u : h;
        waiting.at[limit - list + base_of_group + before] = uvec2(point, from);
    }
    if (!won) {
        return;
    }
    places.at[2u * i] = place | WON;
    uvec2 own = slots_of(point, freed, ReadU32(words));
    if ((place & ON_EDGE) != 0u) {
        uint g = twin(links, h);
        split_side(h, g, point, own.x, own.y);
        split_side(g, h, point, own.y, own.x);
    } else {
        split_triangle(h / 3u, point, own.x, own.y);
    }
}
