// Behind a loop that was run ahead: where its counter is not zero, what follows shall not run. The sizes of all later
// dispatches become zero; sizes that lie in buffers of others are kept, to be put back.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "groups.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 counter;
    U32 halt;           // the number of the first loop that was not done; zero if there is none
    WriteU32 sizes;     // four words a dispatch
    ReadU64 addresses;  // of sizes elsewhere
    WriteU32 saved;     // four words for each of these
    uint number;
    uint size_count;
    uint address_count;
};

void main() {
    bool halts = halt.at[0] == 0u && counter.at[0] != 0u;
    barrier();
    if (!halts) {
        return;
    }
    if (gl_LocalInvocationIndex == 0u) {
        halt.at[0] = number;
    }
    for (uint i = gl_LocalInvocationIndex; i < 4u * size_count; i += WORKGROUP) {
        sizes.at[i] = 0u;
    }
    for (uint i = gl_LocalInvocationIndex; i < address_count; i += WORKGROUP) {
        U32 groups = U32(addresses.at[i]);
        for (uint k = 0u; k < 3u; k++) {
            saved.at[4u * i + k] = groups.at[k];
            groups.at[k] = 0u;
        }
    }
}
