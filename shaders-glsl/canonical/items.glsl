// What this invocation is for; and the mesh.
#ifndef ITEMS_GLSL
#define ITEMS_GLSL

#include "count.glsl"
#include "invocations.glsl"
#include "mesh.glsl"

#endif
