// Where vertices stand in the chains of their constraints.
#ifndef CHAINS_GLSL
#define CHAINS_GLSL

#include "walk.glsl"

// Of a vertex met: its constraint, its place in all chains, and itself. NONE as a place if a superfluous piece met it, or a walk
// that was begun again later.
struct Stop {
    uint constraint;
    uint place;
    uint vertex;
};

Stop stop_at(
    uint i, ReadU32 words, ReadU32 stops, ReadU32 met, ReadU32 offsets, U32x4 pieces, ReadU32 before, uint constraints
) {
    uint item = stops.at[3u * i];
    uint number = stops.at[3u * i + 1u];
    uint vertex = stops.at[3u * i + 2u];
    uint c = item;
    if (item >= constraints) {
        uint p = item - constraints;
        uvec4 piece = pieces.at[p];
        uint first = first_piece(piece, p);
        c = piece.x;
        if (piece_number(piece) > pieces.at[first].w) {
            return Stop(c, NONE, vertex);
        }
        number += (met.at[c] & MET) + (before.at[p] - before.at[first]);
    }
    if (item == c && (met.at[c] & AGAIN) != 0u && i < words.at[STOPS_BEFORE]) {
        return Stop(c, NONE, vertex);
    }
    bool reversed = (met.at[c] & REVERSED) != 0u;
    uint place = reversed ? offsets.at[c + 1u] - 2u - number : offsets.at[c] + 1u + number;
    return Stop(c, place, vertex);
}

// Whether there was room for all, and no walk was lost.
bool is_whole(ReadU32 words, uint stop_limit) {
    return words.at[STOPS] <= stop_limit && words.at[LOST_WALK] == NONE;
}

#endif
