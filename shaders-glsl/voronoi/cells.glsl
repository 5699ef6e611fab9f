// Cells over the bounding box of points: squares whose side is a power of two, as small as keeps them at most SIDE along
// either axis. A bit a cell, rows of SIDE bits.
#ifndef CELLS_GLSL
#define CELLS_GLSL

#include "grid.glsl"
#include "units.glsl"

const uint SIDE = 2048u;
const uint SIDE_BITS = 11u;

// The number of which an ordered integer speaks, as bits.
uint64_t bits_of(uint64_t ordered) {
    return (ordered >> 63) != 0UL ? ordered & ~(1UL << 63) : ~ordered;
}

// The exponent of a number's last place.
int last_place(uint64_t bits) {
    return int(max(uint(bits >> 52) & 0x7ffu, 1u)) - 1075;
}

struct Cells {
    int exponent;
    i64vec2 first;
};

Cells cells_of(ReadU64 bounds) {
    u64vec2 low = u64vec2(bits_of(bounds.at[0]), bits_of(bounds.at[2]));
    u64vec2 high = u64vec2(bits_of(bounds.at[1]), bits_of(bounds.at[3]));
    int finest = max(max(last_place(low.x), last_place(high.x)), max(last_place(low.y), last_place(high.y)));
    uint64_t x = uint64_t(floor_units(high.x, finest) - floor_units(low.x, finest));
    uint64_t y = uint64_t(floor_units(high.y, finest) - floor_units(low.y, finest));
    uvec2 units = unpackUint2x32(max(x, y));
    int length = units.y != 0u ? 33 + findMSB(units.y) : 1 + findMSB(units.x);
    Cells cells;
    cells.exponent = finest + max(length - int(SIDE_BITS), 0);
    // A floor may add a cell to those that the length has room for.
    int64_t across = max(
        floor_units(high.x, cells.exponent) - floor_units(low.x, cells.exponent),
        floor_units(high.y, cells.exponent) - floor_units(low.y, cells.exponent));
    cells.exponent += across >= int64_t(SIDE) ? 1 : 0;
    cells.first = i64vec2(floor_units(low.x, cells.exponent), floor_units(low.y, cells.exponent));
    return cells;
}

#endif
