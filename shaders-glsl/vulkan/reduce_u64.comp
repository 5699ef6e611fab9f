// Sum, minimum or maximum of u64.
#version 460
#extension GL_GOOGLE_include_directive : require
#define VALUE uint64_t
#define READ ReadU64
#define WRITE WriteU64
#include "reduce.glsl"
