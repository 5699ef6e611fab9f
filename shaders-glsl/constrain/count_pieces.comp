// Long walks in pieces, 1 of 3: how many later pieces all listed walkers should have.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "invocations.glsl"
#include "mesh.glsl"
#include "pieces.glsl"
#include "wanted_pieces.glsl"
#define WORDS U32
#include "tallies.glsl"

layout(push_constant, std430) uniform Args {
    ReadPoints positions;
    ReadU32x2 ends; // by walker
    ReadU32 list;   // walkers
    ReadU32 listed; // how many
    MaybeReadU32 known; // by walker: whether it goes in one piece
    U32 piece_count; // zeros before; the sum in the third word and the fourth
    int exponent;
    uint limit;       // of walkers in the list
    uint piece_length; // in places
};

shared uint sum;

void main() {
    uint count = min(listed.at[0], limit);
    if (gl_LocalInvocationIndex == 0u) {
        sum = 0u;
    }
    barrier();
    uint mine = 0u;
    for (uint i = item_index(); i < count; i += item_stride()) {
        uint walker = list.at[i];
        if (!in_one_piece(known, walker)) {
            uvec2 both = ends.at[walker];
            Point a = point_at(positions, both.x);
            Point b = point_at(positions, both.y);
            mine += wanted_pieces(a, b, exponent, piece_length) - 1u;
        }
    }
    if (mine != 0u) {
        atomicAdd(sum, mine);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && sum != 0u) {
        add_wide(piece_count, 2u, sum);
    }
}
