// What this invocation is for; and the mesh.
#ifndef ITEMS_GLSL
#define ITEMS_GLSL

layout(local_size_x_id = 0, local_size_x = 256) in;

#include "count.glsl"
#include "groups.glsl"
#include "mesh.glsl"

// What this invocation is for, of all items of the dispatch; may lie beyond the end.
uint item_index() {
    return group_index() * WORKGROUP + gl_LocalInvocationIndex;
}

#endif
