// A tile: what one workgroup of a scan reads, 16 words an invocation. A subgroup owns a row of them; in step j, lane l
// takes the four words at 4 (j S + l) of that row, so that lanes read side by side and the order of words is the order of
// (subgroup, step, lane).
#ifndef TILE_GLSL
#define TILE_GLSL

#include "buffers.glsl"
#include "groups.glsl"

const uint STEPS = 4u;
const uint TILE = WORKGROUP * 4u * STEPS;

// Where the four words of a step begin.
uint tile_place(uint tile, uint j) {
    return tile * TILE + 4u * (gl_SubgroupID * STEPS * gl_SubgroupSize + j * gl_SubgroupSize + gl_SubgroupInvocationID);
}

// Four words from `place` on, zeros beyond the end.
uvec4 load4(ReadU32 from, uint place, uint end) {
    if (place + 4u <= end) {
        return ReadU32x4(from).at[place / 4u];
    }
    uvec4 words = uvec4(0u);
    for (uint k = 0u; k < 4u; k++) {
        if (place + k < end) {
            words[k] = from.at[place + k];
        }
    }
    return words;
}

#endif
