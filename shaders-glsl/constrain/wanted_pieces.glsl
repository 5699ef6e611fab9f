// How many pieces a walker should have.
#ifndef WANTED_PIECES_GLSL
#define WANTED_PIECES_GLSL

#include "predicates.glsl"
#include "units.glsl"

const uint MOST_PIECES = 4096u;
// AT_HUB of insert.glsl: walks from hubs go in one piece.
const uint IN_ONE_PIECE = 2u;

uint wanted_pieces(Point a, Point b, int exponent, uint piece_length) {
    int64_t x = abs(floor_units(packUint2x32(b.xy), exponent) - floor_units(packUint2x32(a.xy), exponent));
    int64_t y = abs(floor_units(packUint2x32(b.zw), exponent) - floor_units(packUint2x32(a.zw), exponent));
    // Within a twelfth of what it is.
    int64_t length = max(x, y) + (min(x, y) * 3 >> 3);
    return uint(clamp(length / int64_t(piece_length), int64_t(1), int64_t(MOST_PIECES)));
}

bool in_one_piece(MaybeReadU32 known, uint walker) {
    return present(known) && (known.at[walker] & IN_ONE_PIECE) != 0u;
}

#endif
