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
    U32 starts;
    ReadU32 summaries;
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
    // The band of the top of all that is merged, the range of its stack, and the band of the stack before; the top itself.
    uint last = 0xffffu;
    uint low = 0u;
    uint high = 0u;
    uint previous = 0xffffu;
    ivec2 top = ivec2(0);
    uint top_from = 0u;
    // Asked for one band ahead: nothing else has to be waited for unless a stack changes.
    uvec4 coming = ReadU32x4(summaries).at[stacks];
    for (uint b = 0u; b < bands; b++) {
        uvec4 summary = coming;
        coming = ReadU32x4(summaries).at[stacks + min(b + 1u, bands - 1u)];
        uint start = row + b * band;
        uint end = summary.w;
        uint first = 0u;
        uint column = summary.x >> 16;
        ivec2 site = ivec2(column, int(summary.x & 0xffffu) - int(y));
        uint next = end > 1u ? summary.z >> 16 : width;
        uint wins_from = 0u;
        while (first < end && last != 0xffffu) {
            wins_from = takes_over(top, site);
            if (wins_from <= top_from) {
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
                if (last != 0xffffu) {
                    uint entry = entries.at[row + last * band + high - 1u];
                    top = site_of(entry, y);
                    top_from = entry >> 16;
                }
                continue;
            }
            if (wins_from < next) {
                break;
            }
            // The newcomer wins nothing: what is left to it belongs to the next one, or lies beyond the row.
            first++;
            if (first < end) {
                uint entry = entries.at[start + first];
                column = entry & 0xffffu;
                site = site_of(entry, y);
                next = first + 1u < end ? entries.at[start + first + 1u] >> 16 : width;
            }
        }
        if (first == end) {
            live.at[stacks + b] = 0u;
            continue;
        }
        if (last == 0xffffu) {
            // Nothing is left before it, so that all pixels up to the next one are its own.
            wins_from = 0u;
        } else {
            live.at[stacks + last] = previous << 16 | high << 8 | low;
        }
        entries.at[start + first] = wins_from << 16 | column;
        live.at[stacks + b] = last << 16 | end << 8 | first;
        starts.at[stacks + b] = wins_from;
        previous = last;
        last = b;
        low = first;
        high = end;
        top = ivec2(summary.y >> 16, int(summary.y & 0xffffu) - int(y));
        top_from = first + 1u == end ? wins_from : summary.z & 0xffffu;
    }
    if (last != 0xffffu) {
        live.at[stacks + last] = previous << 16 | high << 8 | low;
    }
    uint begins = width;
    uint word = live.at[stacks + bands - 1u];
    uint start = starts.at[stacks + bands - 1u];
    for (uint b = bands; b > 0u;) {
        b--;
        uint ahead = stacks + max(b, 1u) - 1u;
        uint word_ahead = live.at[ahead];
        uint start_ahead = starts.at[ahead];
        if ((word & 0xffu) < (word >> 8 & 0xffu)) {
            begins = start;
        } else {
            starts.at[stacks + b] = begins;
        }
        word = word_ahead;
        start = start_ahead;
    }
}
