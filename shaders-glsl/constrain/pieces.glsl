// Long walks in pieces.
//
// A *walker* is what is to walk: a constraint, or a part of one between two vertices. Its first piece begins at a vertex.
// Its later ones stand together in a list, in order, four words each: the walker; the number of the piece, from 1, in the
// upper half of a word and how many pieces the walker has in the lower; the half-edge that the piece begins by crossing, or
// NONE; and, in the first of them, the least number of a piece that came to the end of the walker.
//
// A piece ends where the next one begins that has a beginning, or else at the end of the walker. Where beginnings do not
// stand in order along it, a piece comes to the end though there are later ones: those are superfluous, and the pieces up to
// the first that came to the end are the whole walk.
#ifndef PIECES_GLSL
#define PIECES_GLSL

#include "buffers.glsl"

BUFFER(U32x4, uvec4, 16, );
BUFFER(ReadU32x2, uvec2, 8, readonly);

const uint AT_VERTEX = 0x80000000u;
const uint NO_PIECE = 0xffffffffu;

uint piece_number(uvec4 piece) {
    return piece.y >> 16;
}

uint piece_count_of(uvec4 piece) {
    return piece.y & 0xffffu;
}

// Where the first later piece of a walker stands, of which one stands at p.
uint first_piece(uvec4 piece, uint p) {
    return p + 1u - piece_number(piece);
}

// Behind the last one, for the first.
uint pieces_end(uvec4 piece, uint first) {
    return first + piece_count_of(piece) - 1u;
}

// Of the pieces from one place to another, where the first begins that has a beginning.
uint next_beginning(U32x4 pieces, uint from, uint to) {
    for (uint p = from; p < to; p++) {
        uint h = pieces.at[p].z;
        if (h != NO_PIECE) {
            return h;
        }
    }
    return NO_PIECE;
}

#endif
