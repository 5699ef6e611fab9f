// Borders between two colors, from one digital Voronoi vertex to the next. The two colors stay the same along it, so that a step
// reads only the two pixels ahead.
//
// Those that include this have `colors`, `vertices`, `first`, `width` and `height` among their arguments.
#ifndef BORDERS_GLSL
#define BORDERS_GLSL

uint triangles_of(uvec2 bits) {
    return uint(bitCount(bits.x) + bitCount(bits.y));
}

// The half-edge that crosses side s of a vertex with the repeated color on pixels r and r + 1; r is 4 with four colors.
uint half_edge(uint slot, uint r, uint s) {
    if (r == 4u) {
        return 3u * slot + (s == 0u ? 2u : s == 1u ? 0u : s + 1u);
    }
    return 3u * slot + ((s + 3u - r & 3u) + 2u) % 3u;
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

// The half-edge of the vertex that a border has reached, with a step in this direction.
uint half_edge_at(uvec2 sides, ivec2 at, ivec2 step) {
    // It is reached by the opposite side; counterclockwise from there left, right, ahead right, ahead left.
    uvec2 found = ahead(at, step);
    uint arrived = step.y != 0 ? uint(1 - step.y) : uint(2 + step.x);
    uint r = sides.y == found.y ? 1u : found.y == found.x ? 2u : found.x == sides.x ? 3u : 4u;
    uint word = uint(at.y) * words_in_row(width) + uint(at.x) / 32u;
    uvec2 before = vertices.at[word] & ((1u << (uint(at.x) & 31u)) - 1u);
    uint slot = first.at[word] + triangles_of(before);
    return half_edge(slot, r == 4u ? 4u : arrived + r & 3u, arrived);
}

// South, east, north, west as a step, and back.
ivec2 step_of(uint side) {
    return side == 0u ? ivec2(0, -1) : side == 1u ? ivec2(1, 0) : side == 2u ? ivec2(0, 1) : ivec2(-1, 0);
}

uint side_of(ivec2 step) {
    return step.y != 0 ? uint(1 + step.y) : uint(2 - step.x);
}

#endif
