// A pass of the radix sort of u64 keys, 2 of 2: moves each key, and its value, to its place.
#version 460
#extension GL_GOOGLE_include_directive : require
#define KEY uint64_t
#define KEY_WORDS 2
#define READ ReadU64
#define WRITE WriteU64
#include "sort_move.glsl"
