// Repair, 4 of 4: finds the rest of the debris, and then recolors the rest of it if told to, in rounds of one workgroup; at most
// ROUNDS of them, then `unfinished` says whether to go on.
//
// First, what has become debris because a neighbor has lost its color is found, and loses its own; until there is none. Then all that is listed takes the best color on offer, and where that changes a pixel the debris around it is listed
// for the next round; until nothing changes.
//
// Two lists take turns, each with bits of its own for what stands on it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "repairs.glsl"

layout(constant_id = 1) const uint ROUNDS = 256u;

const uint FINDING = 0u;
const uint ALL_FOUND = 1u;
const uint RECOLORING = 2u;

// Places in `progress`, four words apart.
const uint MARKED = 0u;    // how many; then of each of the turns of spread_debris
const uint TURNS = 4u;     // with that of marking
const uint BEGIN = 16u;    // of the debris of the last round
const uint END = 20u;      // of all debris; 0 before the first round
const uint PHASE = 24u;
const uint LENGTH = 28u;   // of the list
const uint IN_OTHER = 32u; // which list
const uint LISTED = 40u;   // after two turns of recolor_debris; at 36 after one

layout(push_constant, std430) uniform Args {
    SharedU32 colors;
    ReadU32 sites;
    SharedU32 list;        // the debris
    SharedU32 other_list;
    SharedU32 debris_bits;
    SharedU32 listed_bits; // zeros, or what stands on `list`
    SharedU32 other_bits;
    ReadU32 progress;
    WriteU32 progressed;   // the same, after
    WriteU32 count;        // of the debris
    WriteU32 unfinished;
    uint width;
    uint height;
    uint recolors;         // 0: only finds
};

shared uint found;

void wait_for_all() {
    memoryBarrierBuffer();
    memoryBarrierShared();
    barrier();
}

void find_more(uint begin, uint end) {
    uint lane = gl_LocalInvocationIndex;
    // An invocation for each neighbor.
    for (uint i = begin + lane / 8u; i < end; i += WORKGROUP / 8u) {
        uint there = new_debris(colors, sites, debris_bits, list.at[i], lane % 8u, uvec2(width, height));
        if (there != NONE) {
            list.at[atomicAdd(found, 1u)] = there;
        }
    }
    wait_for_all();
}

void recolor_all(SharedU32 source, SharedU32 source_bits, uint length, SharedU32 target, SharedU32 target_bits) {
    for (uint i = gl_LocalInvocationIndex; i < length; i += WORKGROUP) {
        uint index = source.at[i];
        atomicAnd(source_bits.at[index >> 5], ~(1u << (index & 31u)));
        uint listed = recolor(colors, sites, debris_bits, target_bits, index, uvec2(width, height));
        uint to = listed == 0u ? 0u : atomicAdd(found, uint(bitCount(listed)));
        while (listed != 0u) {
            uint k = uint(findLSB(listed));
            target.at[to] = index_of(neighbor(pixel_at(index, width), k, width, height), width);
            to++;
            listed &= listed - 1u;
        }
    }
    wait_for_all();
}

void main() {
    if (group_index() != 0u || progress.at[MARKED] == 0u) {
        return;
    }
    uint lane = gl_LocalInvocationIndex;
    uint begin = progress.at[BEGIN];
    uint end = progress.at[END];
    if (end == 0u) {
        for (uint turn = 0u; turn < TURNS; turn++) {
            begin = end;
            end += progress.at[MARKED + 4u * turn];
        }
    }
    uint phase = progress.at[PHASE];
    uint length = phase == ALL_FOUND ? progress.at[LISTED] : progress.at[LENGTH];
    bool in_other = progress.at[IN_OTHER] != 0u;
    if (recolors != 0u && phase == ALL_FOUND) {
        phase = RECOLORING;
    }
    wait_for_all();

    bool finished = phase != FINDING && length == 0u;
    for (uint round = 0u; round < ROUNDS && !finished; round++) {
        if (lane == 0u) {
            found = phase == FINDING ? end : 0u;
        }
        wait_for_all();
        if (phase == FINDING && begin < end) {
            find_more(begin, end);
            begin = end;
            end = found;
        } else if (phase == FINDING) {
            phase = recolors != 0u ? RECOLORING : ALL_FOUND;
            length = end;
            finished = recolors == 0u;
        } else {
            if (in_other) {
                recolor_all(other_list, other_bits, length, list, listed_bits);
            } else {
                recolor_all(list, listed_bits, length, other_list, other_bits);
            }
            length = found;
            in_other = !in_other;
            finished = length == 0u;
        }
        wait_for_all();
    }
    if (lane == 0u) {
        count.at[0] = end;
        progressed.at[BEGIN] = begin;
        progressed.at[END] = end;
        progressed.at[PHASE] = phase;
        progressed.at[LENGTH] = length;
        progressed.at[IN_OTHER] = in_other ? 1u : 0u;
        unfinished.at[0] = phase == RECOLORING && length == 0u ? 0u : 1u;
    }
}
