// Dualize, 4 of 4: the links of half-edges whose borders are long.
//
// Between two sites a border lies along their bisector, and no two sites have more than one (their edge would be there twice),
// so that wherever these two colors meet it is theirs. So it is taken in leaps: farther and farther on, then back by halves,
// and the rest in steps. Along the side of the grid, where a site may have several borders, many pixels ahead are read at once.
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
    ReadRows triangles;
    WriteRows links;
    U32 lost; // the first corner from which a border leads nowhere
    ReadU32x2 far;
    ReadU32 far_count;
    uint width;
    uint height;
    uint far_limit;
};

#include "borders.glsl"

// Of four steps each: turns after a leap before the next, turns after a leap that leads nowhere, and more than any border of a
// flooded diagram has.
const uint NEAR = 3u;
const uint LOST = 1024u;
const uint LONGEST = 1u << 20;
// Rows or columns that the first leap tries, and those that are left to steps.
const int LEAP = 16;
const int LAST = 4;
// Pixels along the side of the grid that are read at once.
const int AT_ONCE = 16;

// Two sites seen along their border, `u`, and across it, `v`; `low` and `high` by the latter.
struct Bisector {
    bool by_rows; // u is y
    int forward;  // which way the border is followed
    ivec2 low;    // v, u
    ivec2 high;
    uvec2 colors;
    ivec2 size; // of the grid
    int bias;   // pixels in the middle are those of the higher one
};

Bisector bisector_of(uvec2 sides) {
    uvec2 packed = uvec2(pixels.at[sides.x], pixels.at[sides.y]);
    ivec2 left = ivec2(packed.x & 0xffffu, packed.x >> 16);
    ivec2 right = ivec2(packed.y & 0xffffu, packed.y >> 16);
    ivec2 across = right - left;
    Bisector b;
    b.by_rows = abs(across.x) >= abs(across.y);
    b.forward = (b.by_rows ? across.x : -across.y) > 0 ? 1 : -1;
    b.size = ivec2(width, height);
    if (!b.by_rows) {
        left = left.yx;
        right = right.yx;
        b.size = b.size.yx;
    }
    bool left_is_low = left.x < right.x;
    b.low = left_is_low ? left : right;
    b.high = left_is_low ? right : left;
    b.colors = left_is_low ? sides : sides.yx;
    // Ties go to the least x, and then to the least y.
    b.bias = !b.by_rows && b.high.y < b.low.y ? 1 : 0;
    return b;
}

// Where the two colors meet at `u`, if they do: the first `v` that is the higher one's; else 0.
int meets(Bisector b, int u) {
    if (u < 0 || u >= b.size.y) {
        return 0;
    }
    ivec2 squares = ivec2(b.low.y - u, b.high.y - u);
    squares *= squares;
    int numerator = b.high.x * b.high.x + squares.y - (b.low.x * b.low.x + squares.x) - b.bias;
    if (numerator < 0) {
        return 0;
    }
    int v = numerator / (2 * (b.high.x - b.low.x)) + 1;
    if (v >= b.size.x) {
        return 0;
    }
    uvec2 index = b.by_rows ? uvec2(u) * width + uvec2(v - 1, v) : uvec2(v - 1, v) * width + uvec2(u);
    return uvec2(colors.at[index.x], colors.at[index.y]) == b.colors ? v : 0;
}

// Goes as far along a border as it can be foretold; whether anywhere.
bool leaps(uvec2 sides, inout ivec2 at, inout ivec2 step) {
    Bisector b = bisector_of(sides);
    int start = b.by_rows ? at.y : at.x;
    start -= b.forward > 0 ? 0 : 1;
    int reached = 0;
    int reached_v = 0;
    int by = LEAP;
    bool farther = true;
    while (by >= LAST) {
        int v = meets(b, start + b.forward * (reached + by));
        if (v != 0) {
            reached += by;
            reached_v = v;
        }
        farther = farther && v != 0;
        by = farther ? 2 * by : by / 2;
    }
    if (reached == 0) {
        return false;
    }
    int begin = start + b.forward * reached + (b.forward > 0 ? 0 : 1);
    at = b.by_rows ? ivec2(reached_v, begin) : ivec2(begin, reached_v);
    step = b.by_rows ? ivec2(0, b.forward) : ivec2(b.forward, 0);
    return true;
}

// Goes straight on along the side of the grid, as far as the site stays the same, at most AT_ONCE steps.
void go_straight(uvec2 sides, inout ivec2 at, ivec2 step) {
    int sum = step.x + step.y - 1 >> 1;
    bool is_left = sides.x != GHOST;
    uint site = is_left ? sides.x : sides.y;
    ivec2 inside = at + (is_left ? ivec2(step.x - step.y - 1 >> 1, sum) : ivec2(sum, step.y - step.x - 1 >> 1));
    uint differs = 1u << AT_ONCE;
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        ivec2 pixel = inside + (k + 1) * step;
        differs |= uint(color_of(colors, uint(pixel.x), uint(pixel.y), width, height) != site) << k;
    }
    at += findLSB(differs) * step;
}

// The half-edge where a border ends.
uint follow(uvec2 sides, ivec2 at, ivec2 step) {
    bool is_outer = sides.x == GHOST || sides.y == GHOST;
    uint turns = 0u;
    uint next_leap = 0u;
    uint give_up = LONGEST;
    ivec4 before_leap;
    while (true) {
        if (is_outer) {
            go_straight(sides, at, step);
        } else if (turns == next_leap) {
            next_leap = 2u * turns + NEAR;
            ivec4 here = ivec4(at, step);
            if (leaps(sides, at, step) && give_up == LONGEST) {
                before_leap = here;
                give_up = turns + LOST;
            }
        } else if (turns >= give_up) {
            // Flooding gives no border where this happens. In steps, then.
            at = before_leap.xy;
            step = before_leap.zw;
            next_leap = LONGEST;
            give_up = LONGEST + 1u;
        }
        // Several steps a turn, since llvmpipe ends all loops of an invocation after 65535 turns.
        if (reaches(sides, at, step) || reaches(sides, at, step) || reaches(sides, at, step) || reaches(sides, at, step)) {
            return half_edge_at(sides, at, step);
        }
        turns++;
        if (turns == LONGEST) {
            return GHOST;
        }
    }
}

void main() {
    uint count = min(far_count.at[0], far_limit);
    for (uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex; i < count;
         i += gl_NumWorkGroups.x * gl_NumWorkGroups.y * WORKGROUP) {
        uvec2 from = far.at[i];
        uint h = from.x & HALF_EDGE;
        uint corner = from.y & HALF_EDGE;
        ivec2 at = ivec2(corner % (width + 1u), corner / (width + 1u));
        uvec2 sides = uvec2(destination(triangles, h), origin(triangles, h));
        uint link = follow(sides, at, step_of(from.x >> 31 | (from.y >> 31) << 1));
        set_link(links, h, link);
        if (link == GHOST) {
            atomicMin(lost.at[0], corner);
        }
    }
}
