// Of sorted keys, a one for each that differs from the one before; zeros else.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU64 keys;
    WriteU32 flags;
    uint count;
};

void main() {
    uint p = item_index();
    if (p < count) {
        flags.at[p] = p == 0u || keys.at[p] != keys.at[p - 1u] ? 1u : 0u;
    }
}
