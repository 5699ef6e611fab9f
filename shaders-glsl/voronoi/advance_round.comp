// Between the kernels of a round: workgroups for as many items as a counter says, zero for the counter that is filled next
// (which may be the same), and the number of rounds that had something to do.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

BUFFER(MaybeU32, uint, 4, );

layout(push_constant, std430) uniform Args {
    ReadU32 counter;
    WriteU32 groups;
    WriteU32 zeroed;
    MaybeU32 rounds;
    uint items; // of one workgroup
};

void main() {
    if (item_index() != 0u) {
        return;
    }
    uint count = counter.at[0];
    uint wanted = count / items + uint(count % items != 0u);
    uint rows = wanted / 65535u + uint(wanted % 65535u != 0u);
    groups.at[0] = rows <= 1u ? wanted : wanted / rows + uint(wanted % rows != 0u);
    groups.at[1] = rows;
    groups.at[2] = min(rows, 1u);
    zeroed.at[0] = 0u;
    if (present(rounds) && count != 0u) {
        rounds.at[0] += 1u;
    }
}
