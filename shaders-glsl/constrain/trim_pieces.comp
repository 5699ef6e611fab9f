// Later pieces that turned out to be superfluous met nothing; what the others met belongs to the chain of their constraint.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"

layout(push_constant, std430) uniform Args {
    U32x4 pieces;
    U32 piece_met;
    U32 lengths;
    ReadU32 piece_count;
    uint piece_limit;
};

void main() {
    uint count = min(piece_count.at[0], piece_limit);
    for (uint p = item_index(); p < count; p += item_stride()) {
        uvec4 piece = pieces.at[p];
        if (piece_number(piece) > pieces.at[first_piece(piece, p)].w) {
            piece_met.at[p] = 0u;
        } else if (piece_met.at[p] != 0u) {
            atomicAdd(lengths.at[piece.x], piece_met.at[p]);
        }
    }
}
