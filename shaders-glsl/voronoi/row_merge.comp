// Coloring, 6 of 8: merges stacks of each row from left to right, in place: entries at the end of the left ones and at the
// beginning of each next one win nothing any more. An invocation merges `group` bands of a row, which have been merged by
// `unit` before. When that is the whole row, `starts` gets the first pixel of each band's stack; an empty one has that of the
// next. Else it gets, at the first band of a group, the last band of it whose stack is not empty.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "row.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 nearest;
    ReadU32 wanted;
    U32 entries;
    U32 live;
    U32 starts;
    uint width;
    uint height;
    uint band;  // columns
    uint unit;  // bands
    uint group; // bands
};

const uint NO_BAND = 0xffffu;
const uint AT_ONCE = 8u;

ivec2 site_of(uint entry, uint y) {
    uint column = entry & 0xffffu;
    return ivec2(column, int(nearest_row(nearest, column, y, width)) - int(y));
}

void main() {
    uint bands = (width + band - 1u) / band;
    uint groups = (bands + group - 1u) / group;
    uint y = item_index() / groups;
    if (y >= height || !wanted_rows(wanted, y, y + 1u)) {
        return;
    }
    uint begin = item_index() % groups * group;
    uint end_band = min(begin + group, bands);
    uint stacks = y * bands;
    uint row = y * width;
    // The band of the top of all that is merged, the range of its stack, and the band of the stack before; the top itself.
    uint last = NO_BAND;
    uint low = 0u;
    uint high = 0u;
    uint previous = NO_BAND;
    ivec2 top = ivec2(0);
    uint top_from = 0u;
    for (uint b0 = begin; b0 < end_band; b0 += unit) {
        uint unit_last = unit == 1u ? b0 : starts.at[stacks + b0];
        uint b = b0;
        uint word = unit_last == NO_BAND ? 0u : live.at[stacks + b];
        uint first = word & 0xffu;
        uint end = word >> 8 & 0xffu;
        uint wins_from = 0u;
        bool survives = false;
        while (unit_last != NO_BAND && !survives) {
            if (first == end) {
                live.at[stacks + b] = 0u;
                if (b == unit_last) {
                    break;
                }
                b++;
                word = live.at[stacks + b];
                first = word & 0xffu;
                end = word >> 8 & 0xffu;
                continue;
            }
            uint start = row + b * band;
            uint entry = entries.at[start + first];
            wins_from = 0u;
            if (last == NO_BAND) {
                // Nothing is left before it, so that all pixels up to the next one are its own.
                survives = true;
            } else {
                wins_from = takes_over(top, site_of(entry, y));
                if (wins_from <= top_from) {
                    // The top wins nothing.
                    high--;
                    if (high == low) {
                        live.at[stacks + last] = 0u;
                        last = previous;
                        if (last != NO_BAND) {
                            uint there = live.at[stacks + last];
                            low = there & 0xffu;
                            high = there >> 8 & 0xffu;
                            previous = there >> 16;
                        }
                    }
                    if (last != NO_BAND) {
                        uint new_top = entries.at[row + last * band + high - 1u];
                        top = site_of(new_top, y);
                        top_from = new_top >> 16;
                    }
                    continue;
                }
                uint next = width;
                if (first + 1u < end) {
                    next = entries.at[start + first + 1u] >> 16;
                } else {
                    for (uint c = b + 1u; c <= unit_last && next == width; c++) {
                        uint there = live.at[stacks + c];
                        if ((there & 0xffu) < (there >> 8 & 0xffu)) {
                            next = entries.at[row + c * band + (there & 0xffu)] >> 16;
                        }
                    }
                }
                // One that wins nothing leaves what is left to it to the next one, or that lies beyond the row.
                survives = wins_from < next;
                first += survives ? 0u : 1u;
            }
            if (survives) {
                entries.at[start + first] = wins_from << 16 | (entry & 0xffffu);
            }
        }
        if (!survives) {
            continue;
        }
        if (last != NO_BAND) {
            live.at[stacks + last] = previous << 16 | high << 8 | low;
        }
        previous = last;
        if (b != unit_last) {
            // The others behind it stay as they are.
            live.at[stacks + b] = last << 16 | end << 8 | first;
            word = live.at[stacks + unit_last];
            first = word & 0xffu;
            end = word >> 8 & 0xffu;
            previous = word >> 16;
        }
        last = unit_last;
        low = first;
        high = end;
        uint new_top = entries.at[row + last * band + high - 1u];
        top = site_of(new_top, y);
        top_from = new_top >> 16;
    }
    if (last != NO_BAND) {
        live.at[stacks + last] = previous << 16 | high << 8 | low;
    }
    if (group < bands) {
        starts.at[stacks + begin] = last;
        return;
    }
    // Some at a time, so that their reads do not wait for each other.
    uint begins = width;
    for (uint end = bands; end > 0u; end -= min(end, AT_ONCE)) {
        uint words[AT_ONCE];
        uint first_pixels[AT_ONCE];
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            words[k] = k < end ? live.at[stacks + end - 1u - k] : 0u;
        }
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            uint first = words[k] & 0xffu;
            bool is_empty = first >= (words[k] >> 8 & 0xffu);
            first_pixels[k] = is_empty ? NONE : entries.at[row + (end - 1u - k) * band + first] >> 16;
        }
        [[unroll]] for (uint k = 0u; k < AT_ONCE; k++) {
            begins = min(begins, first_pixels[k]);
            if (k < end) {
                starts.at[stacks + end - 1u - k] = begins;
            }
        }
    }
}
