// How often each of 256 digits stands in each tile, digit by digit: counts[digit * tiles + tile].
layout(local_size_x_id = 0, local_size_x = 128) in;
#include "count.glsl"
#include "groups.glsl"

#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require

layout(constant_id = 1) const uint ITEMS = 8u;

layout(push_constant, std430) uniform Args {
    READ keys;
    WriteU32 counts;
    MaybeReadU32 counter;
    uint limit;
    uint tiles;
    uint shift;
    uint mask;
};

shared uint found[256];

void main() {
    uint tile = group_index();
    if (tile >= tiles) {
        return;
    }
    uint end = length_of(counter, limit);
    uint rank = gl_LocalInvocationIndex;
    for (uint digit = rank; digit < 256u; digit += WORKGROUP) {
        found[digit] = 0u;
    }
    barrier();
    uint first = tile * ITEMS * WORKGROUP + rank;
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint place = first + j * WORKGROUP;
        if (place < end) {
            uint digit = uint(keys.at[place] >> shift) & mask;
            // One atomic for a subgroup that agrees: keys that share a digit would queue up otherwise.
            if (subgroupAllEqual(digit)) {
                uint lanes = subgroupBallotBitCount(subgroupBallot(true));
                if (subgroupElect()) {
                    atomicAdd(found[digit], lanes);
                }
            } else {
                atomicAdd(found[digit], 1u);
            }
        }
    }
    barrier();
    for (uint digit = rank; digit < 256u; digit += WORKGROUP) {
        counts.at[digit * tiles + tile] = found[digit];
    }
}
