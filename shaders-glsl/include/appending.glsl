// Appends what a workgroup found to a list. Those that include this say before what WORDS are.
#ifndef APPENDING_GLSL
#define APPENDING_GLSL

#include "workgroup_scan.glsl"

shared uint place_of_group;

// The place in a list of what this invocation has to append, if it has; every invocation of the workgroup calls it.
uint place_in(WORDS counts, uint at, bool appends) {
    uint total;
    uint before = sum_before(uint(appends), total);
    if (total == 0u) {
        return 0u;
    }
    if (gl_LocalInvocationIndex == 0u) {
        place_of_group = atomicAdd(counts.at[at], total);
    }
    barrier();
    return place_of_group + before;
}

#endif
