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

void main() {
    uint site_count = min(sites.at[0], limit);
    for (uint v = first_item(); v < count; v += item_stride()) {
        positions.at[v] = points.at[order.at[v]];
        if (v < site_count) {
            state.at[v] = v;
        }
    }
}
