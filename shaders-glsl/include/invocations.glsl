// Invocations as items of a list, and workgroups for so many. For kernels whose workgroups have 256 unless told.
#ifndef INVOCATIONS_GLSL
#define INVOCATIONS_GLSL

layout(local_size_x_id = 0, local_size_x = 256) in;

#include "groups.glsl"

// What this invocation is for, of all items of the dispatch; may lie beyond the end.
uint item_index() {
    return group_index() * WORKGROUP + gl_LocalInvocationIndex;
}

uint item_stride() {
    return gl_NumWorkGroups.x * gl_NumWorkGroups.y * WORKGROUP;
}

// Workgroups for so many items: `groups_for` of polder-vulkan.
uvec3 groups_of(uint items) {
    uint wanted = items / WORKGROUP + uint(items % WORKGROUP != 0u);
    uint rows = wanted / 65535u + uint(wanted % 65535u != 0u);
    uint columns = rows <= 1u ? wanted : wanted / rows + uint(wanted % rows != 0u);
    return uvec3(columns, rows, min(rows, 1u));
}

#endif
