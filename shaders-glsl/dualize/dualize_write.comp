// Dualize, 3 of 3: writes the triangles of each digital Voronoi vertex, and links them by following the borders that leave
// it. A workgroup takes 64 corners of each of 14 rows, which at 7 pixels a point hold about as many triangles as it has
// invocations.
//
// The two colors that a border separates stay the same along it, so that a step reads only the two pixels ahead.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "corners.glsl"
#include "groups.glsl"

BUFFER(ReadU32x2, uvec2, 8, readonly);

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
    uint width;
    uint height;
};

const uint ROWS = 14u;
const uint WORDS = 2u * ROWS;
// No border of a flooded diagram is nearly as long.
const uint LONGEST = 1u << 22;

// For each word of the tile: vertices, those with two triangles, its first slot, triangles before it in the tile.
shared uvec4 words[WORDS];
// For each triangle of the tile: its corner in the tile, and whether it is the second there.
shared uint places[WORDS * 64u];

uint triangles_of(uvec2 bits) {
    return uint(bitCount(bits.x) + bitCount(bits.y));
}

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

// The half-edge that crosses side s of a vertex.
uint half_edge(uint slot, uint r, uint s) {
    if (r == 4u) {
        return 3u * slot + (s == 0u ? 2u : s == 1u ? 0u : s + 1u);
    }
    return 3u * slot + ((s + 3u - r & 3u) + 2u) % 3u;
}

// The side that half-edge k of a vertex's triangle crosses; not for the edge between its two triangles.
uint side(uint r, bool is_second, uint k) {
    if (r == 4u) {
        return is_second ? k + 2u : k == 0u ? 1u : 0u;
    }
    return r + 1u + (k + 1u) % 3u & 3u;
}

// The pixels ahead of a corner, left and right.
uvec2 ahead(ivec2 at, ivec2 step) {
    // Where they lie of the corner: 0 or -1.
    int sum = step.x + step.y - 1 >> 1;
    ivec2 left = at + ivec2(step.x - step.y - 1 >> 1, sum);
    ivec2 right = at + ivec2(sum, step.y - step.x - 1 >> 1);
    return uvec2(
        color_of(colors, uint(left.x), uint(left.y), width, height),
        color_of(colors, uint(right.x), uint(right.y), width, height));
}

// Goes to the next corner of a border with these colors left and right, and turns with it; whether it is a vertex.
bool reaches(uvec2 sides, inout ivec2 at, inout ivec2 step) {
    at += step;
    uvec2 found = ahead(at, step);
    if (found.x == sides.y) {
        step = ivec2(-step.y, step.x);
        return false;
    }
    if (found.y == sides.x) {
        step = ivec2(step.y, -step.x);
        return false;
    }
    return found != sides;
}

// The half-edge where the border that leaves a corner by side s ends.
uint follow(uint x, uint y, uint s, uvec2 sides) {
    // South, east, north, west as a step.
    ivec2 step = s == 0u ? ivec2(0, -1) : s == 1u ? ivec2(1, 0) : s == 2u ? ivec2(0, 1) : ivec2(-1, 0);
    ivec2 at = ivec2(x, y);
    // Several steps a turn, since llvmpipe ends all loops of an invocation after 65535 turns.
    uint steps = 0u;
    while (!reaches(sides, at, step) && !reaches(sides, at, step) && !reaches(sides, at, step)
        && !reaches(sides, at, step)) {
        steps += 4u;
        if (steps >= LONGEST) {
            return GHOST;
        }
    }
    // It is reached by the opposite side; counterclockwise from there left, right, ahead right, ahead left.
    uvec2 found = ahead(at, step);
    uint arrived = step.y != 0 ? uint(1 - step.y) : uint(2 + step.x);
    uint r = sides.y == found.y ? 1u : found.y == found.x ? 2u : found.x == sides.x ? 3u : 4u;
    uint word = uint(at.y) * words_in_row(width) + uint(at.x) / 32u;
    uvec2 before = vertices.at[word] & ((1u << (uint(at.x) & 31u)) - 1u);
    uint slot = first.at[word] + triangles_of(before);
    return half_edge(slot, r == 4u ? 4u : arrived + r & 3u, arrived);
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
        [[unroll]] for (uint k = 0u; k < 3u; k++) {
            uint h = 3u * slot + k;
            set_apex(triangles, h, corners[k]);
            if (r == 4u && k == (is_second ? 2u : 1u)) {
                set_link(links, h, is_second ? h - 4u : h + 4u);
                continue;
            }
            uvec2 sides = uvec2(corners[(k + 2u) % 3u], corners[(k + 1u) % 3u]);
            uint link = follow(x, y, side(r, is_second, k), sides);
            set_link(links, h, link);
            if (link == GHOST) {
                atomicMin(lost.at[0], y * (width + 1u) + x);
            }
        }
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
