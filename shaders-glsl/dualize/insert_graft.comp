// Insertion, 3 of 4 of a round: points that got all they claimed split it, the others go on the next list.
//
// Links between the parts are new; outer edges keep the name of the other side that it had before, until `insert_relink`
// renews it. For each point `rounds` says in which round it was inserted.
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
    WriteU32 rounds;
    U32 words;
    uint limit;
};

shared uint base_of_group;

void put(uint t, uvec3 corner) {
    set_corners(triangles, t, corner.x, corner.y, corner.z);
}

// Rows of two slots; most are neighbors, which makes half as many stores.
void put_pair(Rows rows, uint s, uint u, uvec3 first, uvec3 second) {
    if (u == s + 1u && (s & 1u) == 0u) {
        U32x2 pairs = U32x2(rows);
        uint at = 3u * (s >> 1);
        pairs.at[at] = first.xy;
        pairs.at[at + 1u] = uvec2(first.z, second.x);
        pairs.at[at + 2u] = second.yz;
    } else {
        for (uint k = 0u; k < 3u; k++) {
            rows.at[3u * s + k] = first[k];
            rows.at[3u * u + k] = second[k];
        }
    }
}

// Into the triangle t: slot t has a, b, p after, s has b, c, p and u has c, a, p.
void split_triangle(uint t, uint p, uint s, uint u) {
    uvec3 corner = corners(triangles, t);
    uvec2 outer = uvec2(twin(links, 3u * t), twin(links, 3u * t + 1u));
    set_apex(triangles, 3u * t + 2u, p);
    set_link(links, 3u * t, 3u * s + 1u);
    set_link(links, 3u * t + 1u, 3u * u);
    put_pair(triangles, s, u, uvec3(corner.y, corner.z, p), uvec3(corner.z, corner.x, p));
    put_pair(links, s, u, uvec3(3u * u + 1u, 3u * t, outer.x), uvec3(3u * t + 1u, 3u * s, outer.y));
    claims.at[CLAIM * t + SPLIT] = p << 2 | 3u;
}

// One side of an edge: `side` leads to p after, and the slot s has its apex, p and its end.
void split_side(uint side, uint p, uint s) {
    uint outer = twin(links, next_edge(side));
    put(s, uvec3(apex(triangles, side), p, destination(triangles, side)));
    set_apex(triangles, prev_edge(side), p);
    link(links, next_edge(side), 3u * s + 2u);
    set_link(links, 3u * s + 1u, outer);
    claims.at[CLAIM * (side / 3u) + SPLIT] = p << 2 | side % 3u;
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
    rounds.at[point] = words.at[ROUND];
    uvec2 own = slots_of(point, freed, ReadU32(words));
    if ((place & ON_EDGE) != 0u) {
        uint g = twin(links, h);
        split_side(h, point, own.x);
        split_side(g, point, own.y);
        link(links, h, 3u * own.y);
        link(links, g, 3u * own.x);
    } else {
        split_triangle(h / 3u, point, own.x, own.y);
    }
}
