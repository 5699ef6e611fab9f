// Dualize, 3 of 4: writes the triangles of each digital Voronoi vertex, and links them by following the borders that leave
// it. A workgroup takes 64 corners of each of 14 rows, which at 7 pixels a point hold about as many triangles as it has
// invocations. Where sites are far apart borders are long, and one invocation would hold up all others: a border that is still
// under way after some steps is listed, if there is room, for the next kernel.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "corners.glsl"
#include "groups.glsl"
#include "append.glsl"

BUFFER(ReadU32x2, uvec2, 8, readonly);
BUFFER(WriteU32x2, uvec2, 8, writeonly);

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 pixels; // of sites
    ReadU32x2 vertices;
    ReadU32 first; // slots of the words of corners
    ReadU32 slots; // how many
    WriteRows triangles;
    WriteRows links;
    U32 lost;   // the first corner that a border leaves and leads nowhere
    U32 folded; // the first finite triangle that is not counterclockwise
    WriteU32x2 far; // half-edge, and the corner that its border has come to; their highest bits: the side where it goes on
    U32 far_count;
    uint width;
    uint height;
    uint far_limit;
};

#include "borders.glsl"

const uint ROWS = 14u;
const uint WORDS = 2u * ROWS;
// Steps that are made here, and more than any border of a flooded diagram has.
layout(constant_id = 1) const uint NEAR = 12u;
const uint LONGEST = 1u << 22;

// For each word of the tile: vertices, those with two triangles, its first slot, triangles before it in the tile.
shared uvec4 words[WORDS];
// For each triangle of the tile: its corner in the tile, and whether it is the second there.
shared uint places[WORDS * 64u];

uvec4 colors_around(uint x, uint y) {
    return uvec4(
        color_of(colors, x - 1u, y - 1u, width, height),
        color_of(colors, x, y - 1u, width, height),
        color_of(colors, x, y, width, height),
        color_of(colors, x - 1u, y, width, height));
}

// With three colors around, the first of the two pixels that share one; 4 with four colors.
uint repeated(uvec4 c) {
    return c.x == c.y ? 0u : c.y == c.z ? 1u : c.z == c.w ? 2u : c.w == c.x ? 3u : 4u;
}

// The side that half-edge k of a vertex's triangle crosses; not for the edge between its two triangles.
uint side(uint r, bool is_second, uint k) {
    if (r == 4u) {
        return is_second ? k + 2u : k == 0u ? 1u : 0u;
    }
    return r + 1u + (k + 1u) % 3u & 3u;
}

// A border on its way: the next step, from where.
struct Walk {
    ivec2 at;
    ivec2 step;
};

// Whether the border comes to a vertex soon.
bool arrives_soon(uvec2 sides, inout Walk walk) {
    [[dont_unroll]] for (uint step = 0u; step < NEAR; step++) {
        if (reaches(sides, walk.at, walk.step)) {
            return true;
        }
    }
    return false;
}

// Follows the border however far it goes. Several steps a turn, since llvmpipe ends all loops of an invocation after 65535 turns.
bool arrives(uvec2 sides, inout Walk walk) {
    [[dont_unroll]] for (uint step = 0u; step < LONGEST; step += 4u) {
        if (reaches(sides, walk.at, walk.step) || reaches(sides, walk.at, walk.step)
            || reaches(sides, walk.at, walk.step) || reaches(sides, walk.at, walk.step)) {
            return true;
        }
    }
    return false;
}

// Lists a border, if there is room.
bool is_listed(uint h, Walk walk) {
    uint place = append(far_count, 0u);
    if (place < far_limit) {
        uint leaving = side_of(walk.step);
        uint corner = uint(walk.at.y) * (width + 1u) + uint(walk.at.x);
        far.at[place] = uvec2(h | (leaving & 1u) << 31, corner | (leaving & 2u) << 30);
    }
    return place < far_limit;
}

void main() {
    // One site alone has no triangle, and a diagram that is not good none either.
    uint count = slots.at[0];
    if (count == 0u) {
        return;
    }
    uint rank = rank_in_group();
    uvec2 tile = gl_WorkGroupID.xy * uvec2(64u, ROWS);
    if (rank < WORDS) {
        uvec4 word = uvec4(0u);
        uint column = tile.x / 32u + rank % 2u;
        uint y = tile.y + rank / 2u;
        if (y <= height && column < words_in_row(width)) {
            uint at = y * words_in_row(width) + column;
            word = uvec4(vertices.at[at], first.at[at], 0u);
        }
        words[rank] = word;
    }
    barrier();
    if (rank < WORDS) {
        uint before = 0u;
        for (uint i = 0u; i < rank; i++) {
            before += triangles_of(words[i].xy);
        }
        words[rank].w = before;
    }
    barrier();
    for (uint corner = rank; corner < WORDS * 32u; corner += WORKGROUP) {
        uvec4 word = words[corner / 32u];
        uint bit = corner & 31u;
        if ((word.x >> bit & 1u) != 0u) {
            uint to = word.w + triangles_of(word.xy & ((1u << bit) - 1u));
            places[to] = corner << 1u;
            if ((word.y >> bit & 1u) != 0u) {
                places[to + 1u] = corner << 1u | 1u;
            }
        }
    }
    barrier();
    uint in_tile = words[WORDS - 1u].w + triangles_of(words[WORDS - 1u].xy);
    for (uint triangle = rank; triangle < in_tile; triangle += WORKGROUP) {
        uint corner = places[triangle] >> 1u;
        bool is_second = (places[triangle] & 1u) != 0u;
        uvec4 word = words[corner / 32u];
        uint slot = word.z + triangle - word.w;
        if (slot >= count) {
            continue;
        }
        uint x = tile.x + (corner & 63u);
        uint y = tile.y + corner / 64u;
        uvec4 c = colors_around(x, y);
        uint r = repeated(c);
        uvec3 corners;
        if (r == 4u) {
            corners = is_second ? c.xzw : c.xyz;
        } else {
            corners = uvec3(c[r + 1u & 3u], c[r + 2u & 3u], c[r + 3u & 3u]);
        }
        set_corners(triangles, slot, corners.x, corners.y, corners.z);
        uvec3 row = uvec3(GHOST);
        [[dont_unroll]] for (uint k = 0u; k < 3u; k++) {
            uint h = 3u * slot + k;
            uint link = GHOST;
            if (r == 4u && k == (is_second ? 2u : 1u)) {
                link = is_second ? h - 4u : h + 4u;
            } else {
                Walk walk = Walk(ivec2(x, y), step_of(side(r, is_second, k)));
                uvec2 sides = corners.zy;
                bool arrived = arrives_soon(sides, walk);
                if (arrived || !is_listed(h, walk)) {
                    arrived = arrived || arrives(sides, walk);
                    if (arrived) {
                        link = half_edge_at(sides, walk.at, walk.step);
                    } else {
                        atomicMin(lost.at[0], y * (width + 1u) + x);
                    }
                }
            }
            corners = corners.yzx;
            row = uvec3(row.yz, link);
        }
        set_links(links, slot, row.x, row.y, row.z);
        if (corners.x != GHOST && corners.y != GHOST && corners.z != GHOST) {
            uvec3 at = uvec3(pixels.at[corners.x], pixels.at[corners.y], pixels.at[corners.z]);
            ivec2 a = ivec2(at.y & 0xffffu, at.y >> 16) - ivec2(at.x & 0xffffu, at.x >> 16);
            ivec2 b = ivec2(at.z & 0xffffu, at.z >> 16) - ivec2(at.x & 0xffffu, at.x >> 16);
            if (a.x * b.y <= a.y * b.x) {
                atomicMin(folded.at[0], slot);
            }
        }
    }
}
