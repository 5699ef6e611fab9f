// What the kernels of stage 4 share.
//
// Points that wait stand in a list with the half-edge from which the next walk to each starts, in any order. There are two
// lists, of `limit` entries each, one behind the other: a round reads one and writes the other, and PARITY says which.
//
// For each point of the list two words: its place, and its score or, later, the second triangle of its edge. The place is
// three times the slot of a triangle, or with ON_EDGE a half-edge, the lower one of its edge; NONE for
// a point that is done. WON says that it got what it claims.
//
// For each slot two words: the least score that claims it, and the least precedence among points with that score. Behind its
// links stands when it was split last, with the mark SPLIT: four times the round, and 3 if the point lies inside, or else which
// of its edges was split.
#ifndef INSERT_GLSL
#define INSERT_GLSL

#include "invocations.glsl"
#include "mesh.glsl"

BUFFER(U32x2, uvec2, 8, );
BUFFER(ReadU32x2, uvec2, 8, readonly);

const uint ON_EDGE = 0x80000000u;
const uint WON = 0x40000000u;
const uint PLACE = 0x3fffffffu;

const uint CLAIM = 2u;
const uint SCORE = 0u;
const uint FIRST = 1u;

// Notes behind links that are of flips have no such mark.
const uint SPLIT = 0x40000000u;

// The words that steer. Points in the list that is read, and in the other one.
const uint WAITING = 0u;
const uint NEXT = 1u;
const uint PARITY = 2u;
// The number of the round, from 1.
const uint ROUND = 3u;
// Workgroups for the points that wait.
const uint GROUPS = 4u;
// Workgroups that are done with the last kernel of a round.
const uint FINISHED = 8u;
// Points that wait, as long as the mesh has not fallen behind; once it has; and rounds in a row in which it seemed to.
const uint WAITING_STEADY = 12u;
const uint WAITING_BEHIND = 24u;
const uint SLOW = 7u;
const uint SLOW_ROUNDS = 2u;
// Once it has: workgroups for all triangles, for a round's ghost flips and for kernels of one, or zero.
const uint MESH_GROUPS = 36u;
const uint WIDE_GROUPS = 40u;
const uint ONE_GROUP = 44u;
// Edges that were tested in this round, and how many of them were illegal.
const uint TESTED = 48u;
const uint ILLEGAL = 49u;
// The corners of the triangle that sectors are seen from, and its slot.
const uint CENTER = 9u;
const uint CENTER_SLOT = 28u;
// Points below this number have the slots that `freed` says, and point 0 those two if it is not one of them.
const uint SITES = 13u;
const uint GIVEN = 32u;
// Whether the mesh has any triangle. Without a finite one: the first and last of its vertices or, if it is empty, of all
// points; and the least priority of the points off the line through them.
const uint CHAIN = 14u;
const uint ENDS = 30u;
const uint APEX = 29u;
// Whether the hull could not be closed.
const uint OPEN_HULL = 19u;
// What is reported.
const uint INSERTED = 16u;
// The same before this round.
const uint INSERTED_BEFORE = 20u;
const uint DUPLICATES = 17u;
// The lowest point whose walk did not end.
const uint LOST = 18u;

// Who goes first where scores do not tell: `reference::key::precedence`.
uint precedence(uint point) {
    uint x = bitfieldReverse(point) + 0x5bd1e995u;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    return x ^ (x * 0x8d22f6e6u);
}

// So many items are taken, or so many workgroups.
void set_groups(U32 words, uint place, uvec3 size) {
    for (uint k = 0u; k < 3u; k++) {
        words.at[place + k] = size[k];
    }
}

// The two slots of a point.
uvec2 slots_of(uint point, ReadU32x2 freed, ReadU32 words) {
    if (point < words.at[SITES]) {
        return freed.at[point];
    }
    return point == 0u ? uvec2(words.at[GIVEN], words.at[GIVEN + 1u]) : uvec2(2u * point - 2u, 2u * point - 1u);
}

#endif
