// Places of the triangles of a long list: one workgroup sorts it by its keys, four bits at a time, least first.
//
// A pass counts the digits, then goes over the list once more in steps of one entry an invocation: entries of one digit
// find each other by ballots in their subgroup, and a table of the subgroups' counts says how many come before.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "count.glsl"
#include "groups.glsl"

#extension GL_KHR_shader_subgroup_ballot : require

BUFFER(SharedU32, uint, 4, coherent);

layout(push_constant, std430) uniform Args {
    ReadU32 long_lists;
    ReadU32 long_count;
    ReadU32 names;
    ReadU32 starts;
    ReadU32 named_starts;
    SharedU32 list;
    SharedU32 keys;
    SharedU32 other_list; // scratch, as long as the list
    SharedU32 other_keys;
    WriteU32 places;
    uint passes; // even
};

const uint DIGITS = 16u;

shared uint table[WORKGROUP / 4u * DIGITS]; // for each subgroup, how often it has each digit
shared uint bases[DIGITS];

void clear_table() {
    for (uint i = gl_LocalInvocationIndex; i < gl_NumSubgroups * DIGITS; i += WORKGROUP) {
        table[i] = 0u;
    }
}

uint column_sum(uint digit) {
    uint sum = 0u;
    for (uint i = 0u; i < gl_NumSubgroups; i++) {
        sum += table[i * DIGITS + digit];
    }
    return sum;
}

void pass(SharedU32 from_list, SharedU32 from_keys, SharedU32 to_list, SharedU32 to_keys, uint from, uint n, uint shift) {
    uint rank = rank_in_group();
    clear_table();
    barrier();
    for (uint i = rank; i < n; i += WORKGROUP) {
        atomicAdd(table[gl_SubgroupID * DIGITS + (from_keys.at[from + i] >> shift & (DIGITS - 1u))], 1u);
    }
    barrier();
    for (uint digit = rank; digit < DIGITS; digit += WORKGROUP) {
        bases[digit] = column_sum(digit);
    }
    barrier();
    if (rank == 0u) {
        uint sum = 0u;
        for (uint digit = 0u; digit < DIGITS; digit++) {
            uint count = bases[digit];
            bases[digit] = sum;
            sum += count;
        }
    }
    for (uint step = 0u; step < n; step += WORKGROUP) {
        barrier();
        clear_table();
        barrier();
        uint i = step + rank;
        bool here = i < n;
        uint key = here ? from_keys.at[from + i] : 0u;
        uint entry = here ? from_list.at[from + i] : 0u;
        uint digit = key >> shift & (DIGITS - 1u);
        uvec4 peers = subgroupBallot(here);
        [[unroll]] for (uint bit = 0u; bit < 4u; bit++) {
            bool set = (digit >> bit & 1u) != 0u;
            uvec4 vote = subgroupBallot(set);
            peers &= set ? vote : ~vote;
        }
        uint lower = subgroupBallotExclusiveBitCount(peers);
        if (here && lower == 0u) {
            table[gl_SubgroupID * DIGITS + digit] = subgroupBallotBitCount(peers);
        }
        barrier();
        if (here) {
            uint to = from + bases[digit] + lower;
            for (uint j = 0u; j < gl_SubgroupID; j++) {
                to += table[j * DIGITS + digit];
            }
            to_list.at[to] = entry;
            to_keys.at[to] = key;
        }
        barrier();
        for (uint digit = rank; digit < DIGITS; digit += WORKGROUP) {
            bases[digit] += column_sum(digit);
        }
    }
    memoryBarrierBuffer();
    barrier();
}

void main() {
    uint which = group_index();
    if (which >= long_count.at[0]) {
        return;
    }
    uint v = long_lists.at[which];
    uint from = starts.at[v];
    uint n = starts.at[v + 1u] - from;
    for (uint i = 0u; i < passes; i += 2u) {
        pass(list, keys, other_list, other_keys, from, n, 4u * i);
        pass(other_list, other_keys, list, keys, from, n, 4u * i + 4u);
    }
    uint first = named_starts.at[names.at[v]];
    for (uint i = gl_LocalInvocationIndex; i < n; i += WORKGROUP) {
        places.at[list.at[from + i] / 3u] = first + i;
    }
}
