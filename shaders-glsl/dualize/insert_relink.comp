// Insertion, 4 of 4 of a round: the outer edges of what was split get their links, the edges around new vertices go on the
// list for flips, none twice, those of new ghost triangles on the list for the hull, and claims are cleared. The last
// workgroup turns to the next round.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "edge_list.glsl"
#include "workgroup_scan.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadU32 places;
    U32 claims;
    WriteU32 edges;
    U32 edge_count;
    WriteU32 hull_edges;
    U32 hull_count;
    U32 words;
    uint edge_limit;
    uint hull_limit;
};

shared uint place_of_group;

// The name that half-edge g has after the round, and whether its triangle was split; who split it then sees to that side. The
// links between the parts tell where it went.
uint renamed(uint g, out bool split) {
    uint t = g / 3u;
    uvec4 row = FourWords(links)[2u * t].row;
    split = row.w >> 2 == (SPLIT >> 2 | words.at[ROUND]);
    if (!split) {
        return g;
    }
    uint k = g - 3u * t;
    uint edge = row.w & 3u;
    if (edge == 3u) {
        return k == 0u ? row.x + 1u : k == 1u ? row.y + 2u : g;
    }
    // Behind the edge, what is left of the triangle leads to the rest of it.
    if (k != (edge + 1u) % 3u) {
        return g;
    }
    return (k == 0u ? row.x : k == 1u ? row.y : row.z) - 1u;
}

void main() {
    uint i = item_index();
    uint place = i < words.at[WAITING] ? places.at[2u * i] : NONE;
    bool won = place != NONE && (place & WON) != 0u;
    bool on_edge = (place & ON_EDGE) != 0u;
    uint h = place & PLACE;
    uint t = h / 3u;
    uvec4 outer = uvec4(NONE);
    uvec4 parts = uvec4(t, NONE, NONE, NONE);
    uint count = 0u;
    if (place != NONE) {
        claims.at[CLAIM * t + SCORE] = NONE;
        claims.at[CLAIM * t + FIRST] = NONE;
        if (on_edge) {
            uint other = places.at[2u * i + 1u];
            claims.at[CLAIM * other + SCORE] = NONE;
            claims.at[CLAIM * other + FIRST] = NONE;
        }
    }
    if (won) {
        uvec3 row = links_of(links, t);
        uvec2 own = row.xy / 3u;
        parts.yz = own;
        outer = uvec4(3u * t + 2u, 3u * own.x + 2u, 3u * own.y + 2u, NONE);
        count = 3u;
        if (on_edge) {
            own = uvec2(link_of(links, next_edge(h)), link_of(links, h)) / 3u;
            uint g = link_of(links, 3u * own.x);
            outer = uvec4(prev_edge(h), prev_edge(g), 3u * own.x + 1u, 3u * own.y + 1u);
            parts = uvec4(t, g / 3u, own);
            count = 4u;
        }
    }
    // With few points left to insert, flips are left to stage 5.
    bool flips = words.at[NEXT] >= (words.at[INSERTED] - words.at[INSERTED_BEFORE] + 15u) / 16u;
    // All is read before anything is written nearby.
    uint others[4];
    bool split[4];
    bvec4 ghost = bvec4(false);
    uint listed = 0u; // a bit for each
    [[unroll]] for (uint k = 0u; k < 4u; k++) {
        if (k < count) {
            uint side = outer[k];
            uvec3 corner = corners(triangles, parts[k]);
            others[k] = renamed(link_of(links, side) & HALF_EDGE, split[k]);
            ghost[k] = any(equal(corner, uvec3(GHOST)));
            // An edge between two that were split is on the list by its lower side.
            if (flips && (!split[k] || side < others[k])) {
                uint at = side - 3u * parts[k];
                bool finite = !ghost[k] || (at == 0u ? corner.x : at == 1u ? corner.y : corner.z) == GHOST;
                listed |= uint(finite) << k;
            }
        }
    }
    [[unroll]] for (uint k = 0u; k < 4u; k++) {
        if (k < count) {
            set_link(links, outer[k], others[k]);
            if (!split[k]) {
                set_link(links, others[k], outer[k]);
            }
            if (ghost[k]) {
                append_triangle(hull_edges, hull_count, hull_limit, parts[k]);
            }
        }
    }
    uint all;
    uint next_place = sum_before(bitCount(listed), all);
    if (gl_LocalInvocationIndex == 0u && all > 0u) {
        place_of_group = atomicAdd(edge_count.at[0], all);
    }
    barrier();
    next_place += place_of_group;
    for (uint k = 0u; k < count; k++) {
        if ((listed >> k & 1u) != 0u && next_place < edge_limit) {
            edges.at[next_place++] = outer[k];
        }
    }

    if (gl_LocalInvocationIndex != 0u) {
        return;
    }
    uint groups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    if (atomicAdd(words.at[FINISHED], 1u) != groups - 1u) {
        return;
    }
    // Of this dispatch only this invocation is left.
    words.at[FINISHED] = 0u;
    words.at[INSERTED_BEFORE] = words.at[INSERTED];
    uint next = words.at[NEXT];
    set_groups(words, GROUPS, groups_of(next));
    words.at[WAITING] = next;
    words.at[NEXT] = 0u;
    words.at[PARITY] ^= 1u;
    words.at[ROUND] += 1u;
}
