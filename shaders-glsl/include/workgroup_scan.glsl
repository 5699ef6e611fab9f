// Sums over a workgroup. The row of subgroups is short (16 of 32 lanes, 32 of 8), so each invocation adds up the sums of
// the subgroups before its own.
#ifndef WORKGROUP_SCAN_GLSL
#define WORKGROUP_SCAN_GLSL

#include "groups.glsl"

#extension GL_KHR_shader_subgroup_arithmetic : require

// Vulkan allows subgroups down to one lane; no device has fewer than 4.
shared uint subgroup_sums[WORKGROUP / 4u];

// The sum over all subgroups before this one, of a value that is uniform in each subgroup; and the sum over all.
uint sum_before_subgroup(uint subgroup_sum, out uint total) {
    barrier();
    if (gl_SubgroupInvocationID == 0u) {
        subgroup_sums[gl_SubgroupID] = subgroup_sum;
    }
    barrier();
    uint before = 0u;
    total = 0u;
    for (uint i = 0u; i < gl_NumSubgroups; i++) {
        before = i == gl_SubgroupID ? total : before;
        total += subgroup_sums[i];
    }
    return before;
}

// The sum of the values of all invocations of lower rank; and the sum over all.
uint sum_before(uint value, out uint total) {
    uint inside = subgroupExclusiveAdd(value);
    return sum_before_subgroup(subgroupAdd(value), total) + inside;
}

#endif
