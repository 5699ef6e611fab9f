// Sum, minimum or maximum of VALUES, which READ and WRITE name; wraps around. Every workgroup strides over the whole input
// and writes one value: run once with many workgroups and once more, with one, over what they wrote.
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "groups.glsl"

layout(constant_id = 1) const uint OPERATION = 0u; // 0 sum, 1 minimum, 2 maximum

layout(push_constant, std430) uniform Args {
    READ values;
    WRITE results;
    MaybeReadU32 counter;
    uint limit;
};

shared VALUE folded[WORKGROUP];

VALUE identity() {
    return OPERATION == 1u ? ~VALUE(0) : VALUE(0);
}

VALUE fold(VALUE a, VALUE b) {
    return OPERATION == 0u ? a + b : OPERATION == 1u ? min(a, b) : max(a, b);
}

void main() {
    uint end = length_of(counter, limit);
    uint rank = gl_LocalInvocationIndex;
    uint stride = WORKGROUP * gl_NumWorkGroups.x;
    VALUE found = identity();
    uint place = gl_WorkGroupID.x * WORKGROUP + rank;
    // Counts down what is left, so that no index can pass 2^32.
    while (place < end) {
        found = fold(found, values.at[place]);
        if (end - place <= stride) {
            break;
        }
        place += stride;
    }
    folded[rank] = found;
    for (uint half_width = WORKGROUP / 2u; half_width > 0u; half_width /= 2u) {
        barrier();
        if (rank < half_width) {
            folded[rank] = fold(folded[rank], folded[rank + half_width]);
        }
    }
    if (rank == 0u) {
        results.at[gl_WorkGroupID.x] = folded[0];
    }
}
