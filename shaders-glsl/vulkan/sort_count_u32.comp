// A pass of the radix sort of u32 keys, 1 of 2: how often each digit stands in each tile.
#version 460
#extension GL_GOOGLE_include_directive : require
#define KEY uint
#define READ ReadU32
#include "sort_count.glsl"
