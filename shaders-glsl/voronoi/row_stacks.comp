// Coloring, 4 of 6: for each row of each band of columns the stack of its proximate sites, those that are nearest to some
// pixel of the whole row. `live` holds for each stack its first entry, its end, and (later) the band before it: 8, 8 and 16
// bits.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "row.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 nearest;
    U32 entries;
    WriteU32 live;
    uint width;
    uint height;
    uint band; // columns, at most 255
};

void main() {
    uint item = item_index();
    uint bands = (width + band - 1u) / band;
    uint y = item / bands;
    uint from = item % bands * band;
    if (y >= height) {
        return;
    }
    uint start = y * width + from;
    uint count = 0u;
    ivec2 top = ivec2(0);
    uint top_from = 0u;
    for (uint x = from; x < min(from + band, width); x++) {
        uint row = nearest.at[y * width + x];
        if (row == NONE) {
            continue;
        }
        ivec2 site = ivec2(x, int(row) - int(y));
        uint wins_from = 0u;
        while (count > 0u) {
            wins_from = takes_over(top, site);
            if (wins_from > top_from) {
                break;
            }
            wins_from = 0u;
            count--;
            if (count > 0u) {
                uint entry = entries.at[start + count - 1u];
                uint column = entry & 0xffffu;
                top = ivec2(column, int(nearest.at[y * width + column]) - int(y));
                top_from = entry >> 16;
            }
        }
        if (wins_from < width) {
            entries.at[start + count] = wins_from << 16 | x;
            count++;
            top = site;
            top_from = wins_from;
        }
    }
    live.at[item] = count << 8;
}
