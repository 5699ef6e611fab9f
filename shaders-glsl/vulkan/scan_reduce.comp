// Exclusive scan, 1 of 3: the sum of each tile of 16 words an invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
uvec4 f(uvec4 words) {
    return words;
}
#include "tile_sum.glsl"
