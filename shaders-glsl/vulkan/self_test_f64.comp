// What the device makes of f64 arithmetic: for each pair of numbers nine results, which the host compares bit by bit.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 64) in;
#include "buffers.glsl"
#include "groups.glsl"

BUFFER(ReadF64, double, 8, readonly);
BUFFER(WriteF64, double, 8, writeonly);

layout(push_constant, std430) uniform Args {
    ReadF64 pairs;
    WriteF64 results;
    uint count;
};

// Dekker's split and product, Knuth's sum: the error terms that predicates rest on.
void split(double a, out double high, out double low) {
    precise double c = 134217729.0LF * a;
    precise double big = c - a;
    precise double h = c - big;
    precise double l = a - h;
    high = h;
    low = l;
}

void main() {
    uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex;
    if (i >= count) {
        return;
    }
    double a = pairs.at[2u * i];
    double b = pairs.at[2u * i + 1u];
    precise double sum = a + b;
    precise double difference = a - b;
    precise double product = a * b;
    precise double quotient = a / b;
    precise double virtual_b = sum - a;
    precise double virtual_a = sum - virtual_b;
    precise double round_b = b - virtual_b;
    precise double round_a = a - virtual_a;
    precise double sum_error = round_a + round_b;
    double ah, al, bh, bl;
    split(a, ah, al);
    split(b, bh, bl);
    precise double e1 = ah * bh;
    precise double e2 = product - e1;
    precise double e3 = al * bh;
    precise double e4 = e2 - e3;
    precise double e5 = ah * bl;
    precise double e6 = e4 - e5;
    precise double e7 = al * bl;
    precise double product_error = e7 - e6;
    uint to = 9u * i;
    results.at[to] = sum;
    results.at[to + 1u] = difference;
    results.at[to + 2u] = product;
    results.at[to + 3u] = quotient;
    results.at[to + 4u] = sum_error;
    results.at[to + 5u] = product_error;
    results.at[to + 6u] = ah;
    results.at[to + 7u] = al;
    results.at[to + 8u] = double(uint(a < b) + 2u * uint(a == b) + 4u * uint(a > b));
}
