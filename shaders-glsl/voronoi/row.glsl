// Entries of a row's stacks: a column in the lower half of a word, and in the upper half the first pixel that its site
// wins against those further left.
#ifndef ROW_GLSL
#define ROW_GLSL

#include "columns.glsl"

// The first pixel, at least 0, that is strictly nearer to the right one of two sites: ties go to the left. Sites are
// (column, row) relative to the row asked for; all sums stay below 2^31.
uint takes_over(ivec2 left, ivec2 right) {
    int numerator = (right.x * right.x + right.y * right.y) - (left.x * left.x + left.y * left.y);
    // (p - right.x)^2 + right.y^2 < (p - left.x)^2 + left.y^2, solved for p: floor(numerator / twice) + 1
    uint twice = uint(2 * (right.x - left.x));
    return numerator < 0 ? 0u : uint(numerator) / twice + 1u;
}

#endif
