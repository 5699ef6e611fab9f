// How many pieces a walker should have.
#ifndef WANTED_PIECES_GLSL
#define WANTED_PIECES_GLSL

#include "cells.glsl"

const uint MOST_PIECES = 4096u;
// AT_HUB of insert.glsl: walks from hubs go in one piece.
const uint IN_ONE_PIECE = 2u;

uint wanted_pieces(Point a, Point b, int64_t low_x, int64_t low_y, int exponent, uint piece_length) {
    i64vec2 across = abs(place_of(b, exponent, low_x, low_y) - place_of(a, exponent, low_x, low_y));
    // Within a twelfth of what it is.
    int64_t length = max(across.x, across.y) + (min(across.x, across.y) * 3 >> 3);
    return uint(clamp(length / int64_t(piece_length), int64_t(1), int64_t(MOST_PIECES)));
}

bool in_one_piece(MaybeReadU32 known, uint walker) {
    return present(known) && (known.at[walker] & IN_ONE_PIECE) != 0u;
}

#endif
