// Coloring, 6 of 8: merges the stacks of each row from left to right, in place: entries at the end of the left ones and at
// the beginning of each next one win nothing any more. `starts` gets the first pixel of each band's stack; an empty one has
// that of the next.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "row.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 nearest;
    ReadU32 wanted;
    U32 entries;
    U32 live;
    WriteU32 starts;
    uint width;
    uint height;
    uint band; // columns
};

ivec2 site_of(uint entry, uint y) {
    uint column = entry & 0xffffu;
    return ivec2(column, int(nearest_row(nearest, column, y, width)) - int(y));
}

void main() {
    uint y = item_index();
    if (y >= height || !wanted_rows(wanted, y, y + 1u)) {
        return;
    }
    uint bands = (width + band - 1u) / band;
    uint stacks = y * bands;
    uint row = y * width;
    // The band of the top of all that is merged, the range of its stack, and the band of the stack before.
    uint last = 0xffffu;
    uint low = 0u;
    uint high = 0u;
    uint previous = 0xffffu;
    for (uint b = 0u; b < bands; b++) {
        uint start = row + b * band;
        uint end = live.at[stacks + b] >> 8 & 0xffu;
        uint first = 0u;
        uint wins_from = 0u;
        while (first < end && last != 0xffffu) {
            uint entry = entries.at[start + first];
            uint top = entries.at[row + last * band + high - 1u];
            wins_from = takes_over(site_of(top, y), site_of(entry, y));
            if (wins_from <= top >> 16) {
                // The top wins nothing.
                wins_from = 0u;
                high--;
                if (high == low) {
                    live.at[stacks + last] = 0u;
                    last = previous;
                    if (last != 0xffffu) {
                        uint word = live.at[stacks + last];
                        low = word & 0xffu;
                        high = word >> 8 & 0xffu;
                        previous = word >> 16;
                    }
                }
                continue;
            }
            uint next = first + 1u < end ? entries.at[start + first + 1u] >> 16 : width;
            if (wins_from < next) {
                break;
            }
            // The newcomer wins nothing: what is left to it belongs to the next one, or lies beyond the row.
            first++;
        }
        if (first == end) {
            live.at[stacks + b] = 0u;
            continue;
        }
        uint entry = entries.at[start + first];
        if (last == 0xffffu) {
            // Nothing is left before it, so that all pixels up to the next one are its own.
            wins_from = 0u;
        } else {
            live.at[stacks + last] = previous << 16 | high << 8 | low;
        }
        entries.at[start + first] = wins_from << 16 | (entry & 0xffffu);
        live.at[stacks + b] = last << 16 | end << 8 | first;
        previous = last;
        last = b;
        low = first;
        high = end;
    }
    if (last != 0xffffu) {
        live.at[stacks + last] = previous << 16 | high << 8 | low;
    }
    uint begins = width;
    for (uint b = bands; b > 0u;) {
        b--;
        uint word = live.at[stacks + b];
        uint first = word & 0xffu;
        if (first < (word >> 8 & 0xffu)) {
            begins = entries.at[row + b * band + first] >> 16;
        }
        starts.at[stacks + b] = begins;
    }
}
