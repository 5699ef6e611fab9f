// Insertion, 2 of 4 of a round: the second step of the claims. Of the points with the least score of a triangle, the one
// with the least precedence gets it. Two words of 32 bits in two steps, since atomics on 64 bits are optional. For a point on
// an edge the second of its triangles takes the place of its score, which has served: links are about to change.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows links;
    ReadU32x2 waiting;
    U32 places;
    U32 claims;
    ReadU32 words;
    uint limit;
};

void claim(uint t, uint score, uint mine) {
    if (claims.at[CLAIM * t + SCORE] == score && claims.at[CLAIM * t + FIRST] > mine) {
        atomicMin(claims.at[CLAIM * t + FIRST], mine);
    }
}

void main() {
    uint i = item_index();
    if (i >= words.at[WAITING]) {
        return;
    }
    uint place = places.at[2u * i];
    if (place == NONE) {
        return;
    }
    uint mine = precedence(waiting.at[words.at[PARITY] * limit + i].x);
    uint score = places.at[2u * i + 1u];
    uint h = place & PLACE;
    claim(h / 3u, score, mine);
    if ((place & ON_EDGE) != 0u) {
        uint other = twin(links, h) / 3u;
        claim(other, score, mine);
        places.at[2u * i + 1u] = other;
    }
}
