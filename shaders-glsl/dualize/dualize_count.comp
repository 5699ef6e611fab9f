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
        for (uint k = 0u; k < gl_SubgroupSize; k += 32u) {
            atomicOr(found[place + k / 32u], ballot[k / 32u] << (rank_in_group() & 31u));
        }
    }
}

void main() {
    for (uint i = rank_in_group(); i < 2u * ROWS * WORDS; i += WORKGROUP) {
        found[i] = 0u;
    }
    barrier();
    uint x = gl_WorkGroupID.x * WORKGROUP + rank_in_group();
    uint first_row = gl_WorkGroupID.y * ROWS;
    uint count = sites.at[0];
    uint necks_here = 0u;
    uint ghosts_here = 0u;
    uint bad_corner = GHOST;
    uint bad_pixel = GHOST;
    uint south_west = color_of(colors, x - 1u, first_row - 1u, width, height);
    uint south_east = color_of(colors, x, first_row - 1u, width, height);
    [[unroll]] for (uint row = 0u; row < ROWS; row++) {
        uint y = first_row + row;
        uint north_west = color_of(colors, x - 1u, y, width, height);
        uint north_east = color_of(colors, x, y, width, height);
        if (x < width && y < height && north_east >= count) {
            bad_pixel = min(bad_pixel, y * width + x);
        }
        uint borders = uint(south_west != south_east) + uint(south_east != north_east) + uint(north_east != north_west)
            + uint(north_west != south_west);
        bool inside = x <= width && y <= height;
        bool repeated = south_west == north_east || south_east == north_west;
        bool is_four = inside && borders == 4u && !repeated;
        bool is_vertex = inside && (borders == 3u || is_four);
        if (inside && borders == 4u && repeated) {
            if (south_west == north_east && south_east == north_west) {
                bad_corner = min(bad_corner, y * (width + 1u) + x);
            } else {
                necks_here++;
            }
        }
        // At the border of the grid two pixels lie outside.
        ghosts_here += uint(is_vertex && (x == 0u || y == 0u || x == width || y == height));
        note(row * WORDS + rank_in_group() / 32u, subgroupBallot(is_vertex));
        note(ROWS * WORDS + row * WORDS + rank_in_group() / 32u, subgroupBallot(is_four));
        south_west = north_west;
        south_east = north_east;
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
        uint y = first_row + i / WORDS;
        uint word = gl_WorkGroupID.x * WORDS + i % WORDS;
        if (y <= height && word < words_in_row(width)) {
            uint to = y * words_in_row(width) + word;
            vertices.at[2u * to] = found[i];
            vertices.at[2u * to + 1u] = found[ROWS * WORDS + i];
            counts.at[to] = uint(bitCount(found[i]) + bitCount(found[ROWS * WORDS + i]));
        }
    }
}
