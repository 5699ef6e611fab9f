// Coordinates in integers: no f64 arithmetic decides where something lies.
#ifndef UNITS_GLSL
#define UNITS_GLSL

#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// floor(x / 2^exponent), saturated at 62 bits.
int64_t floor_units(uint64_t bits, int exponent) {
    uint high = uint(bits >> 32);
    uint biased = high >> 20 & 0x7ffu;
    int64_t magnitude = int64_t(bits & 0xfffffffffffffUL);
    magnitude |= biased == 0u ? int64_t(0) : int64_t(1) << 52;
    int64_t significand = high >> 31 != 0u ? -magnitude : magnitude;
    int shift = int(max(biased, 1u)) - 1075 - exponent;
    if (shift < 0) {
        return significand >> min(-shift, 63);
    }
    if (shift <= 9) {
        return significand << shift;
    }
    return significand == 0 ? int64_t(0) : (significand < 0 ? -(int64_t(1) << 62) : int64_t(1) << 62);
}

#endif
