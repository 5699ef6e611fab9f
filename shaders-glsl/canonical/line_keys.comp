// Points on a line, by one coordinate: integers in the order of the numbers, -0.0 as 0.0; and their indices.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU64 points;
    WriteU64 keys;
    WriteU32 values;
    uint axis; // 0 for x, 1 for y
    uint count;
};

void main() {
    uint i = item_index();
    if (i >= count) {
        return;
    }
    uint64_t bits = points.at[2u * i + axis];
    if ((bits << 1u) == 0ul) {
        bits = 0ul;
    }
    keys.at[i] = (bits >> 63u) != 0ul ? ~bits : bits | 0x8000000000000000ul;
    values.at[i] = i;
}
