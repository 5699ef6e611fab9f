// Bounds of points: five numbers of 64 bits each, the least and the largest x, the least and the largest y, as integers
// ordered like the coordinates; and of the first coordinate that is no finite number twice the point's index, plus one
// if it is the y.
#ifndef BOUNDS_GLSL
#define BOUNDS_GLSL

#include "grid.glsl"

struct Bounds {
    uint64_t low_x;
    uint64_t high_x;
    uint64_t low_y;
    uint64_t high_y;
    uint64_t unfit;
};

Bounds no_bounds() {
    return Bounds(~0UL, 0UL, ~0UL, 0UL, ~0UL);
}

Bounds joined(Bounds a, Bounds b) {
    return Bounds(min(a.low_x, b.low_x), max(a.high_x, b.high_x), min(a.low_y, b.low_y), max(a.high_y, b.high_y),
                  min(a.unfit, b.unfit));
}

shared Bounds bounds_of_lane[WORKGROUP];

// Those of the whole workgroup; for its first invocation.
Bounds joined_in_group(Bounds own) {
    uint rank = gl_LocalInvocationIndex;
    bounds_of_lane[rank] = own;
    for (uint half_width = WORKGROUP / 2u; half_width > 0u; half_width /= 2u) {
        barrier();
        if (rank < half_width) {
            bounds_of_lane[rank] = joined(bounds_of_lane[rank], bounds_of_lane[rank + half_width]);
        }
    }
    return bounds_of_lane[0];
}

void write_bounds(WriteU64 to, uint place, Bounds bounds) {
    to.at[5u * place] = bounds.low_x;
    to.at[5u * place + 1u] = bounds.high_x;
    to.at[5u * place + 2u] = bounds.low_y;
    to.at[5u * place + 3u] = bounds.high_y;
    to.at[5u * place + 4u] = bounds.unfit;
}

#endif
