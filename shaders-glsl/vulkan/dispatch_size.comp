// The workgroups of an indirect dispatch over as many items as a counter says, folded over y as the engine folds them.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 1) in;
#include "count.glsl"

layout(push_constant, std430) uniform Args {
    MaybeReadU32 counter;
    WriteU32 groups;
    uint limit;
    uint items; // of one workgroup
};

void main() {
    uint count = length_of(counter, limit);
    uint wanted = count / items + uint(count % items != 0u);
    uint rows = wanted / 65535u + uint(wanted % 65535u != 0u);
    groups.at[0] = rows <= 1u ? wanted : wanted / rows + uint(wanted % rows != 0u);
    groups.at[1] = rows;
    groups.at[2] = min(rows, 1u);
}
