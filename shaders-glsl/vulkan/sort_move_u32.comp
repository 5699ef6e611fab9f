// A pass of the radix sort of u32 keys, 2 of 2: moves each key, and its value, to its place.
#version 460
#extension GL_GOOGLE_include_directive : require
#define KEY uint
#define KEY_WORDS 1
#define READ ReadU32
#define WRITE WriteU32
#include "sort_move.glsl"
