// Sum, minimum or maximum of u32.
#version 460
#extension GL_GOOGLE_include_directive : require
#define VALUE uint
#define READ ReadU32
#define WRITE WriteU32
#include "reduce.glsl"
