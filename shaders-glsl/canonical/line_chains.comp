// The vertices along the constraints of a line, one behind the other, each in the direction of its constraint.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 ends;
    ReadU32 places;
    ReadU32 starts;
    ReadU32 heads; // the names of the vertices, along the line
    WriteU32 chains;
    uint constraints; // at least one
    uint first; // of the vertices written here
    uint limit; // how many are written
};

void main() {
    uint i = item_index();
    if (i >= limit) {
        return;
    }
    uint at = first + i;
    // The last constraint whose chain begins here or before; none is empty.
    uint low = 0u;
    uint high = constraints;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (starts.at[middle] <= at) {
            low = middle;
        } else {
            high = middle;
        }
    }
    uint from = places.at[ends.at[2u * low]];
    uint to = places.at[ends.at[2u * low + 1u]];
    uint along = at - starts.at[low];
    chains.at[i] = heads.at[from <= to ? from + along : from - along];
}
