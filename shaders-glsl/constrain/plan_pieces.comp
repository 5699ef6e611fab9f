// Long walks in pieces, 1 of 2: how many pieces each listed walker has, and where its later ones stand.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "mesh.glsl"
#include "cells.glsl"
#include "pieces.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32x2 ends;   // by walker
    ReadU32 list;     // walkers
    ReadU32 listed;   // how many
    MaybeReadU32 barred; // by walker: whether it has to wait, in the third bit
    WriteU32 runs;    // by walker: where its later pieces stand, or NONE
    U32x4 pieces;
    U32 piece_count;  // also those for which there is no room
    int64_t low_x;
    int64_t low_y;
    int exponent;
    uint limit;       // of walkers in the list
    uint piece_limit;
    uint piece_length; // in places
};

const uint MOST_PIECES = 4096u;
// As in insert.glsl.
const uint BARRED = 4u;

void main() {
    uint count = min(listed.at[0], limit);
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint walker = list.at[i];
        if (present(barred) && (barred.at[walker] & BARRED) != 0u) {
            continue;
        }
        uvec2 both = ends.at[walker];
        i64vec2 across = abs(place_of(point_at(positions, both.y), exponent, low_x, low_y) -
            place_of(point_at(positions, both.x), exponent, low_x, low_y));
        // Within a twelfth of what it is.
        int64_t length = max(across.x, across.y) + (min(across.x, across.y) * 3 >> 3);
        uint wanted = uint(clamp(length / int64_t(piece_length), int64_t(1), int64_t(MOST_PIECES)));
        uint run = NONE;
        if (wanted > 1u && piece_count.at[0] < piece_limit) {
            run = atomicAdd(piece_count.at[0], wanted - 1u);
            if (run > piece_limit || piece_limit - run < wanted - 1u) {
                // The walk is not cut. What room is left in the list belongs to nobody.
                for (uint p = run; p < piece_limit && p - run < wanted - 1u; p++) {
                    pieces.at[p] = uvec4(walker, 1u << 16 | 2u, NO_PIECE, 0u);
                }
                run = NONE;
            } else {
                for (uint k = 1u; k < wanted; k++) {
                    pieces.at[run + k - 1u] = uvec4(walker, k << 16 | wanted, NO_PIECE, NONE);
                }
            }
        }
        runs.at[walker] = run;
    }
}
