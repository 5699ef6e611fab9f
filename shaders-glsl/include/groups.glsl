// Workgroups in a row, and invocations in subgroup order.
//
// An axis holds 65535 workgroups, so longer rows are folded over y: the last ones may lie beyond the end, and every
// kernel has to check. The engine asks for full subgroups of one size, so that `rank` numbers the invocations of a
// workgroup without holes.
#ifndef GROUPS_GLSL
#define GROUPS_GLSL

#extension GL_KHR_shader_subgroup_basic : require

#define WORKGROUP gl_WorkGroupSize.x

uint group_index() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

uint rank_in_group() {
    return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
}

#endif
