// Shift: puts every point to its true position in the new order, and marks each site as not pinned.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    ReadPositions points; // by input index
    ReadU32 order;        // the input index of each point
    Points positions;
    U32 state;
    ReadU32 sites; // how many
    uint count;    // points
    uint limit;    // room for sites
};

const uint AT_ONCE = 4u;

void main() {
    uint site_count = min(sites.at[0], limit);
    uint stride = item_stride();
    for (uint i = first_item(); i < count; i += AT_ONCE * stride) {
        uint from[AT_ONCE];
        uvec4 at[AT_ONCE];
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            from[k] = order.at[min(i + k * stride, count - 1u)];
        }
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            at[k] = points.at[from[k]];
        }
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            uint v = i + k * stride;
            if (v < count) {
                positions.at[v] = at[k];
            }
            if (v < site_count) {
                state.at[v] = v;
            }
        }
    }
}
