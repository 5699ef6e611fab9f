// Appending to lists, whose lengths are words among others.
#ifndef APPEND_GLSL
#define APPEND_GLSL

#include "buffers.glsl"

#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require

// A place for one more in a list, from any flow of control.
uint append(U32 words, uint counter) {
    uvec4 here = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) {
        first = atomicAdd(words.at[counter], subgroupBallotBitCount(here));
    }
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(here);
}

// The first of so many places in a list, from any flow of control.
uint reserve(U32 words, uint counter, uint count) {
    uint before = subgroupExclusiveAdd(count);
    uint total = subgroupAdd(count);
    uint first = 0u;
    if (subgroupElect()) {
        first = atomicAdd(words.at[counter], total);
    }
    return subgroupBroadcastFirst(first) + before;
}

#endif
