// Dualize, 1 of 3: finds the digital Voronoi vertices among the corners of the grid. For each word of corners: which are
// vertices, which of these have two triangles, and how many triangles there are. A workgroup takes 256 corners of each of
// 8 rows.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "corners.glsl"
#include "groups.glsl"

#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_shuffle_relative : require

layout(push_constant, std430) uniform Args {
    ReadU32 colors;
    ReadU32 sites;     // how many
    WriteU32 vertices; // two words for a word of corners
    WriteU32 counts;
    U32 necks;     // how many
    U32 ghosts;    // how many ghost triangles
    U32 crossing;  // the first corner where two colors cross
    U32 uncolored; // the first pixel without the color of a site
    uint width;
    uint height;
};

const uint ROWS = 8u;
const uint WORDS = WORKGROUP / 32u;

shared uint found[2u * ROWS * WORDS];

void note(uint place, uvec4 ballot) {
    if (subgroupElect()) {
        if (gl_SubgroupSize == 32u) {
            found[place] = ballot.x;
        } else {
            for (uint k = 0u; k < gl_SubgroupSize; k += 32u) {
                atomicOr(found[place + k / 32u], ballot[k / 32u] << (rank_in_group() & 31u));
            }
        }
    }
}

// The colors of the pixels left and right of x, of which the left one is the right one of the invocation before.
uvec2 pair(uint x, uint y) {
    uint east = color_of(colors, x, y, width, height);
    uint west = subgroupShuffleUp(east, 1u);
    if (gl_SubgroupInvocationID == 0u) {
        west = color_of(colors, x - 1u, y, width, height);
    }
    return uvec2(west, east);
}

void main() {
    for (uint i = rank_in_group(); i < 2u * ROWS * WORDS; i += WORKGROUP) {
        found[i] = 0u;
    }
    barrier();
    uvec2 first = gl_WorkGroupID.xy * uvec2(WORKGROUP, ROWS);
    uint x = first.x + rank_in_group();
    uint count = sites.at[0];
    uint necks_here = 0u;
    uint ghosts_here = 0u;
    uint bad_corner = GHOST;
    uint bad_pixel = GHOST;
    bool at_border = first.x == 0u || first.y == 0u || first.x + WORKGROUP > width || first.y + ROWS > height;
    uvec2 south = pair(x, first.y - 1u);
    [[unroll]] for (uint row = 0u; row < ROWS; row++) {
        uint y = first.y + row;
        uvec2 north = pair(x, y);
        if (north.y >= count && x < width && y < height) {
            bad_pixel = min(bad_pixel, y * width + x);
        }
        // Beyond the grid all colors are one.
        uint borders = uint(south.x != south.y) + uint(south.y != north.y) + uint(north.y != north.x)
            + uint(north.x != south.x);
        bool is_four = borders == 4u;
        if (is_four && (south.x == north.y || south.y == north.x)) {
            is_four = false;
            if (south.x == north.y && south.y == north.x) {
                bad_corner = min(bad_corner, y * (width + 1u) + x);
            } else {
                necks_here++;
            }
        }
        bool is_vertex = is_four || borders == 3u;
        // At the border of the grid two pixels lie outside.
        if (at_border && is_vertex && (x == 0u || y == 0u || x == width || y == height)) {
            ghosts_here++;
        }
        uint word = row * WORDS + rank_in_group() / 32u;
        note(word, subgroupBallot(is_vertex));
        note(ROWS * WORDS + word, subgroupBallot(is_four));
        south = north;
    }
    uint sum = subgroupAdd(necks_here);
    uint ghosts_sum = subgroupAdd(ghosts_here);
    uint least_corner = subgroupMin(bad_corner);
    uint least_pixel = subgroupMin(bad_pixel);
    if (subgroupElect()) {
        if (sum > 0u) {
            atomicAdd(necks.at[0], sum);
        }
        if (ghosts_sum > 0u) {
            atomicAdd(ghosts.at[0], ghosts_sum);
        }
        if (least_corner != GHOST) {
            atomicMin(crossing.at[0], least_corner);
        }
        if (least_pixel != GHOST) {
            atomicMin(uncolored.at[0], least_pixel);
        }
    }
    barrier();
    for (uint i = rank_in_group(); i < ROWS * WORDS; i += WORKGROUP) {
        uint y = first.y + i / WORDS;
        uint word = gl_WorkGroupID.x * WORDS + i % WORDS;
        if (y <= height && word < words_in_row(width)) {
            uint to = y * words_in_row(width) + word;
            vertices.at[2u * to] = found[i];
            vertices.at[2u * to + 1u] = found[ROWS * WORDS + i];
            counts.at[to] = uint(bitCount(found[i]) + bitCount(found[ROWS * WORDS + i]));
        }
    }
}
