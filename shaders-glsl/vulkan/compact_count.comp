// Stream compaction, 1 of 3: the number of set flags in each tile.
#version 460
#extension GL_GOOGLE_include_directive : require
uvec4 f(uvec4 words) {
    return min(words, uvec4(1u));
}
#include "tile_sum.glsl"
