// Coloring, 1 of 6: writes the number of each site into its pixel of a grid that held none.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "grid.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 sites;
    WriteU32 grid;
    MaybeReadU32 counter;
    uint limit;
    uint width;
};

void main() {
    uint site = item_index();
    if (site < length_of(counter, limit)) {
        grid.at[index_of(sites.at[site], width)] = site;
    }
}
