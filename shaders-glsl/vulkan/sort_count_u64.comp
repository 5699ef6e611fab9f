// A pass of the radix sort of u64 keys, 1 of 2: how often each digit stands in each tile.
#version 460
#extension GL_GOOGLE_include_directive : require
#define KEY uint64_t
#define READ ReadU64
#include "sort_count.glsl"
