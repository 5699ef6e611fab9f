// Long walks in pieces, 3 of 3: where each later piece begins. Near the point that divides the walker a vertex to the left of
// it is looked for, and one to the right, and the mesh is walked from the one to the other. On the way is an edge that the
// walker crosses for certain: its ends lie on different sides of the walker, and the walker's on different sides of it. Or a
// vertex turns up that lies on the walker.
//
// What lies farther off than half a piece does not serve: pieces would begin out of order, and some walk to the end.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "steps.glsl"
#include "cells.glsl"
#include "pieces.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    ReadU32x2 ends;
    ReadU32 spokes;
    ReadU32 degrees;
    ReadU32 seeds;
    U32x4 pieces;
    ReadU32 piece_count;
    int64_t low_x;
    int64_t low_y;
    int exponent;
    uint width;
    uint height;
    uint piece_limit;
};

// Cells in which vertices are looked for; how many edges the walks from left to right may cross; and steps, of which there
// are more where a vertex has very many edges.
const uint MOST_CELLS = 13u;
const uint MOST_EDGES = 24u;
const uint MOST_STEPS = 1024u;

// One of the two seeds of the k-th cell around a cell: itself, then at distances 1, 2 and 3 to either side and along the line.
uint seed_near(ivec2 cell, ivec2 aside, uint k, uint which) {
    int ring = int(k + 3u) / 4;
    ivec2 direction = (k & 2u) == 0u ? aside.yx : aside;
    cell += (k & 1u) == 0u ? -ring * direction : ring * direction;
    bool inside = all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(width, height)));
    return inside ? seeds.at[2u * (uint(cell.y) * width + uint(cell.x)) + which] : NONE;
}

// Whether an edge or a vertex, of one end twice, lies less than half a piece from a place, along the walker.
bool is_near(Point p, Point q, i64vec2 place, ivec2 aside, int64_t piece) {
    i64vec2 middle = place_of(p, exponent, low_x, low_y) + place_of(q, exponent, low_x, low_y) >> 1;
    return abs(aside.x == 0 ? middle.x - place.x : middle.y - place.y) * 2 <= piece;
}

// An edge that is crossed by the line from a to b, by its half-edge that begins to the right, or a vertex between a and b; or
// NONE.
uint crossed_near(i64vec2 place, ivec2 aside, int64_t piece, Point a, Point b) {
    ivec2 cell = ivec2(cell_of(place, width, height));
    uint candidate = 0u;
    uint edges = 0u;
    uint left = NONE;
    uint right = NONE;
    bool walks = false;
    Walker walker;
    for (uint step = 0u; step < MOST_STEPS; step++) {
        uint event = LEAVES;
        uint first;
        uint second;
        if (walks) {
            event = advance(walker, triangles, links, positions);
            if (event == TURNS) {
                continue;
            }
            edges++;
            if (event == LOST || edges > MOST_EDGES) {
                return NONE;
            }
            first = event == AT_APEX ? apex(triangles, walker.h) : origin(triangles, walker.h);
            second = event == AT_APEX ? first : destination(triangles, walker.h);
        } else {
            if (left != NONE && right != NONE) {
                // These two have led to nothing.
                left = NONE;
                right = NONE;
            }
            if (candidate == 2u * MOST_CELLS) {
                return NONE;
            }
            first = seed_near(cell, aside, candidate >> 1, candidate & 1u);
            candidate++;
            if (first == NONE) {
                continue;
            }
            second = first;
        }
        // One vertex against the line; or two that are joined by an edge, and the ends of the line against that.
        Point p = point_at(positions, first);
        Point q = point_at(positions, second);
        bool joined = first != second;
        bool apart = true;
        int side_of_first = 0;
        int side_before = 0;
        for (uint k = 0u; k < (joined ? 4u : 1u) && apart; k++) {
            bool against_line = k < 2u;
            Point tested = k == 0u ? p : k == 1u ? q : k == 2u ? a : b;
            int side = orient2d(against_line ? a : p, against_line ? b : q, tested);
            bool on_line = side == 0 && against_line;
            if (on_line && lies_ahead(a, tested, a, b) && lies_ahead(tested, b, a, b) &&
                is_near(tested, tested, place, aside, piece)) {
                return AT_VERTEX | (k == 0u ? first : second);
            }
            apart = side != 0 && ((k & 1u) == 0u || side == -side_before);
            side_of_first = k == 0u ? side : side_of_first;
            side_before = side;
        }
        if (joined && apart && is_near(p, q, place, aside, piece)) {
            return side_of_first < 0 ? walker.h : twin(links, walker.h);
        }
        if (walks) {
            if (event != LEAVES) {
                walks = second != right;
                turn_again(walker, event, links);
            }
        } else {
            left = side_of_first > 0 && left == NONE ? first : left;
            right = side_of_first < 0 && right == NONE ? first : right;
            walks = left != NONE && right != NONE;
            if (walks) {
                walker = turn_from(spokes.at[left], point_at(positions, left), point_at(positions, right));
            }
        }
    }
    return NONE;
}

void main() {
    uint count = min(piece_count.at[0], piece_limit);
    for (uint p = item_index(); p < count; p += item_stride()) {
        uvec4 piece = pieces.at[p];
        uvec2 both = ends.at[piece.x];
        bool reversed = degrees.at[both.y] < degrees.at[both.x];
        Point a = point_at(positions, reversed ? both.y : both.x);
        Point b = point_at(positions, reversed ? both.x : both.y);
        i64vec2 from = place_of(a, exponent, low_x, low_y);
        i64vec2 across = place_of(b, exponent, low_x, low_y) - from;
        i64vec2 place = from + across * int64_t(piece_number(piece)) / int64_t(piece_count_of(piece));
        bool flat_line = abs(across.x) >= abs(across.y);
        int64_t long_way = flat_line ? abs(across.x) : abs(across.y);
        ivec2 aside = flat_line ? ivec2(0, 1) : ivec2(1, 0);
        pieces.at[p].z = crossed_near(place, aside, long_way / int64_t(piece_count_of(piece)), a, b);
    }
}
