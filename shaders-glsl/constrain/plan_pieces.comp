// Long walks in pieces, 2 of 3: how many pieces each listed walker has, and where its later ones stand. If there is no room for
// as many as are wanted all have fewer.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "mesh.glsl"
#include "wanted_pieces.glsl"
#include "pieces.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32x2 ends;   // by walker
    ReadU32 list;     // walkers
    ReadU32 listed;   // how many
    MaybeReadU32 known; // by walker: whether it goes in one piece
    WriteU32 runs;    // by walker: where its later pieces stand, or NONE
    U32x4 pieces;
    U32 piece_count;  // and behind it how many are wanted, in two words
    int exponent;
    uint limit;       // of walkers in the list
    uint piece_limit;
    uint piece_length; // in places
};

void main() {
    uint count = min(listed.at[0], limit);
    uint64_t all = packUint2x32(uvec2(piece_count.at[2], piece_count.at[3]));
    uint share = uint(min(all / uint64_t(max(piece_limit, 1u)), uint64_t(MOST_PIECES))) + 1u;
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint walker = list.at[i];
        if (in_one_piece(known, walker)) {
            runs.at[walker] = NONE;
            continue;
        }
        uvec2 both = ends.at[walker];
        Point a = point_at(positions, both.x);
        Point b = point_at(positions, both.y);
        uint wanted = wanted_pieces(a, b, exponent, piece_length) / share;
        uint run = NONE;
        if (wanted > 1u) {
            run = atomicAdd(piece_count.at[0], wanted - 1u);
            for (uint k = 1u; k < wanted; k++) {
                pieces.at[run + k - 1u] = uvec4(walker, k << 16 | wanted, NO_PIECE, NONE);
            }
        }
        runs.at[walker] = run;
    }
}
