// Mapping, 1 of 7: the pixel of each point, in integers alone from the bits of its coordinates, and a bit for each pixel that
// has a point.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"
#include "units.glsl"

layout(push_constant, std430) uniform Args {
    ReadU64 points;
    WriteU32 pixels;
    U32 bits; // zeros
    int64_t translation_x;
    int64_t translation_y;
    int exponent_x;
    int exponent_y;
    uint side_x;
    uint side_y;
    uint width;
    uint height;
    uint count;
};

uint column_or_row(uint64_t bits, int64_t translation, int exponent, uint side, uint pixels_along) {
    int64_t from_start = floor_units(bits, exponent) - translation;
    if (from_start < 0) {
        return 0u;
    }
    uint64_t units = uint64_t(from_start);
    // Beyond the grid, and everything that a division of 64 bits would be needed for.
    if (units >= uint64_t(side) * pixels_along) {
        return pixels_along - 1u;
    }
    return uint(units / side);
}

void main() {
    uint point = item_index();
    if (point >= count) {
        return;
    }
    uint x = column_or_row(points.at[2u * point], translation_x, exponent_x, side_x, width);
    uint y = column_or_row(points.at[2u * point + 1u], translation_y, exponent_y, side_y, height);
    pixels.at[point] = y << 16 | x;
    uint word = y * pitch_of(width) + (x >> 5);
    uint bit = 1u << (x & 31u);
    // Where many points share a pixel most of them need not queue up.
    if ((bits.at[word] & bit) == 0u) {
        atomicOr(bits.at[word], bit);
    }
}
