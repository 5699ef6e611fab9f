// Take out: follows heirs to vertices that are still there, lists the sites taken out, and puts all that were pinned to
// their true positions. Of an empty mesh, all sites are taken out, without heirs.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    U32 state;
    ReadU32 all; // sites that were pinned
    WriteU32 taken;
    Points positions;
    ReadPositions points; // by input index
    ReadU32 order;
    U32 words;
    ReadU32 sites; // how many
    ReadU32 slots;
    uint limit; // room for sites
};

void main() {
    bool is_empty = slots.at[0] == 0u;
    uint count = words.at[BAD];
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint v = all.at[i];
        uint heir = state.at[v];
        if (heir == v) {
            continue;
        }
        positions.at[v] = points.at[order.at[v]];
        if (!is_empty) {
            // An heir goes in a later round than the vertex that names it.
            for (uint step = 0u; step <= words.at[OUT_ROUNDS] && state.at[heir] != heir; step++) {
                heir = state.at[heir];
            }
            state.at[v] = heir;
            taken.at[append(words, TAKEN)] = v;
        }
    }
    if (!is_empty) {
        return;
    }
    uint site_count = min(sites.at[0], limit);
    for (uint v = first_item(); v < site_count; v += item_stride()) {
        state.at[v] = NONE;
        taken.at[v] = v;
        if (v == 0u) {
            words.at[TAKEN] = site_count;
        }
    }
}
