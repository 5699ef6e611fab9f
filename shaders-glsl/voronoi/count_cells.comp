// Occupancy, 2 of 2: how many cells have points; the same for cells that are twice as wide and high, and so on. A workgroup
// takes 64 by 64 cells, an invocation a row of them.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
#include "buffers.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 bits;
    U32 counts; // zeros; one for each level
};

const uint SIDE = 2048u;
const uint LEVELS = 4u;
const uint KEPT[LEVELS] = {0x55555555u, 0x11111111u, 0x01010101u, 0u};

shared uvec2 rows[64];
shared uint sums[LEVELS];

void main() {
    uint lane = gl_LocalInvocationIndex;
    uint word = (gl_WorkGroupID.y * 64u + lane) * (SIDE / 32u) + gl_WorkGroupID.x * 2u;
    uvec2 row = uvec2(bits.at[word], bits.at[word + 1u]);
    if (lane < LEVELS) {
        sums[lane] = 0u;
    }
    for (uint level = 0u; level < LEVELS; level++) {
        // Bits of cells stand at multiples of 2^level.
        barrier();
        uint found = uint(bitCount(row.x) + bitCount(row.y));
        if (found > 0u && (lane & (1u << level) - 1u) == 0u) {
            atomicAdd(sums[level], found);
        }
        row = (row | row >> (1u << level)) & KEPT[level];
        rows[lane] = row;
        barrier();
        row |= rows[min(lane + (1u << level), 63u)];
    }
    barrier();
    if (lane < LEVELS && sums[lane] > 0u) {
        atomicAdd(counts.at[lane], sums[lane]);
    }
}
