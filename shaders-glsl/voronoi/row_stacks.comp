// Coloring, 5 of 8: for each row of each band of columns the stack of its proximate sites, those that are nearest to some
// pixel of the whole row. A workgroup takes WORKGROUP rows of a band, an invocation each, and keeps the stacks in shared memory.
// `live` holds for each stack its first entry, its end, and (later) the band before it: 8, 8 and 16 bits.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "row.glsl"

layout(constant_id = 1) const uint BAND = 64u; // columns

layout(push_constant, std430) uniform Args {
    ReadU32 nearest;
    ReadU32 wanted;
    WriteU32 entries;
    WriteU32 live;
    uint width;
    uint height;
};

// How many workgroups run at once depends on how little memory they share, so rows are read where they lie: a lane takes all of
// a sector after the other.
shared uint stacks[WORKGROUP * (BAND + 1u)];
shared uint counts[WORKGROUP];

void main() {
    uint bands = (width + BAND - 1u) / BAND;
    uint band = group_index() % bands;
    uint from = band * BAND;
    uint y0 = group_index() / bands * WORKGROUP;
    if (y0 >= height || !wanted_rows(wanted, y0, min(y0 + WORKGROUP, height))) {
        return;
    }
    uint lane = gl_LocalInvocationIndex;
    uint columns = min(BAND, width - from);
    uint rows = min(WORKGROUP, height - y0);
    uint count = 0u;
    uint y = y0 + lane;
    if (y < height) {
        uint stack = lane * (BAND + 1u);
        ivec2 top = ivec2(0);
        uint top_from = 0u;
        for (uint k = 0u; k < columns; k++) {
            uint row = nearest_row(nearest, from + k, y, width);
            if (row == NO_ROW) {
                continue;
            }
            ivec2 site = ivec2(from + k, int(row) - int(y));
            uint wins_from = 0u;
            while (count > 0u) {
                wins_from = takes_over(top, site);
                if (wins_from > top_from) {
                    break;
                }
                wins_from = 0u;
                count--;
                if (count > 0u) {
                    uint entry = stacks[stack + count - 1u];
                    uint column = entry & 0xffffu;
                    top = ivec2(column, int(nearest_row(nearest, column, y, width)) - int(y));
                    top_from = entry >> 16;
                }
            }
            if (wins_from < width) {
                stacks[stack + count] = wins_from << 16 | (from + k);
                count++;
                top = site;
                top_from = wins_from;
            }
        }
        live.at[y * bands + band] = count << 8;
    }
    counts[lane] = count;
    barrier();
    for (uint i = lane; i < rows * BAND; i += WORKGROUP) {
        uint row = i / BAND;
        uint k = i % BAND;
        if (k < counts[row]) {
            entries.at[(y0 + row) * width + from + k] = stacks[row * (BAND + 1u) + k];
        }
    }
}
