// Appends what a workgroup found to the lists of illegal and of deferred edges.
#ifndef FOUND_GLSL
#define FOUND_GLSL

#include "verdict.glsl"
#include "workgroup_scan.glsl"

shared uvec2 found_places;

// Where the illegal and the open edges of this invocation go, of which it has so many; every invocation of the workgroup
// calls it.
uvec2 places_for(WORDS words, uint parity, uint illegal, uint open) {
    uint total;
    uint before = sum_before(illegal | open << 16, total);
    if (total == 0u) {
        return uvec2(0u);
    }
    if (gl_LocalInvocationIndex == 0u) {
        uint some = total & 0xffffu;
        found_places.x = some == 0u ? 0u : atomicAdd(words.at[ILLEGAL_COUNT(parity)], some);
        some = total >> 16;
        found_places.y = some == 0u ? 0u : atomicAdd(words.at[DEFERRED_COUNT], some);
    }
    barrier();
    return found_places + uvec2(before & 0xffffu, before >> 16);
}

#endif
