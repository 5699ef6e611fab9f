// How many vertices of a line a constraint runs through, its ends included; the sum of all in two words, the low one first;
// and how many run through more than two.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 ends;
    ReadU32 places;
    WriteU32 lengths;
    U32 totals; // the sum, then how many pass through vertices
    uint constraints;
    uint count; // of points
};

shared uint low;
shared uint high;
shared uint through;

void main() {
    if (gl_LocalInvocationIndex == 0u) {
        low = 0u;
        high = 0u;
        through = 0u;
    }
    barrier();
    uint i = item_index();
    if (i < constraints) {
        uint from = ends.at[2u * i];
        uint to = ends.at[2u * i + 1u];
        uint length = 0u;
        if (from < count && to < count) {
            length = uint(abs(int(places.at[from] - places.at[to]))) + 1u;
        }
        lengths.at[i] = length;
        // A workgroup's sum takes more than one word.
        if (length != 0u && atomicAdd(low, length) + length < length) {
            atomicAdd(high, 1u);
        }
        if (length > 2u) {
            atomicAdd(through, 1u);
        }
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) {
        uint before = atomicAdd(totals.at[0], low);
        uint carry = high + uint(before + low < low);
        if (carry != 0u) {
            atomicAdd(totals.at[1], carry);
        }
        if (through != 0u) {
            atomicAdd(totals.at[2], through);
        }
    }
}
