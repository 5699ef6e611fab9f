// Moves each key of a tile to its place in the order of one digit, stably.
//
// 1. Each subgroup ranks its own row of keys: lanes with the same digit find each other by one ballot a bit, and the
//    subgroup's counters in shared memory carry over from step to step.
// 2. The counters of all subgroups are summed up, digit by digit and then over the digits: places in the tile.
// 3. Keys go to shared memory in that order, so that neighbors go out to neighboring addresses; values follow.
// Beyond the end stand keys of all ones: they come last in every digit and are not written.
layout(local_size_x_id = 0, local_size_x = 128) in;
#include "count.glsl"
#include "workgroup_scan.glsl"

#extension GL_KHR_shader_subgroup_ballot : require

layout(constant_id = 1) const uint ITEMS = 8u;
layout(constant_id = 2) const uint SUBGROUP = 8u;  // lanes in a subgroup
layout(constant_id = 3) const uint POOL = 4096u;   // at least 256 words a subgroup, and KEY_WORDS words a key

layout(push_constant, std430) uniform Args {
    READ keys;
    MaybeReadU32 values;
    WRITE moved_keys;
    MaybeWriteU32 moved_values;
    ReadU32 starts; // the scanned counts
    MaybeReadU32 counter;
    uint limit;
    uint tiles;
    uint shift;
    uint mask;
};

shared uint pool[POOL];
shared uint digit_base[256];

uint digit_of(KEY key) {
    return uint(key >> shift) & mask;
}

// The lanes of this subgroup that hold the same digit: how many there are, and how many of them are lower.
void peers_of(uint digit, out uint lower, out uint all) {
    if (SUBGROUP <= 32u) {
        uint peers = subgroupBallot(true).x;
        [[unroll]] for (uint bit = 0u; bit < 8u; bit++) {
            bool set = (digit >> bit & 1u) != 0u;
            uint vote = subgroupBallot(set).x;
            peers &= set ? vote : ~vote;
        }
        lower = bitCount(peers & gl_SubgroupLtMask.x);
        all = bitCount(peers);
    } else {
        uvec4 peers = subgroupBallot(true);
        [[unroll]] for (uint bit = 0u; bit < 8u; bit++) {
            bool set = (digit >> bit & 1u) != 0u;
            uvec4 vote = subgroupBallot(set);
            peers &= set ? vote : ~vote;
        }
        lower = subgroupBallotExclusiveBitCount(peers);
        all = subgroupBallotBitCount(peers);
    }
}

void main() {
    uint tile = group_index();
    uint tile_keys = ITEMS * WORKGROUP;
    uint tile_first = tile * tile_keys;
    uint end = length_of(counter, limit);
    if (tile >= tiles || tile_first >= end) {
        return;
    }
    uint rank = rank_in_group();
    uint row = gl_SubgroupID * 256u;
    uint first = tile_first + gl_SubgroupID * ITEMS * gl_SubgroupSize + gl_SubgroupInvocationID;
    bool has_values = present(values);

    KEY key[ITEMS];
    uint value[ITEMS];
    uint place[ITEMS];
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint from = first + j * gl_SubgroupSize;
        key[j] = from < end ? keys.at[from] : ~KEY(0);
    }
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint from = first + j * gl_SubgroupSize;
        value[j] = has_values && from < end ? values.at[from] : 0u;
    }
    for (uint i = gl_SubgroupInvocationID; i < 256u; i += gl_SubgroupSize) {
        pool[row + i] = 0u;
    }
    subgroupMemoryBarrierShared();
    subgroupBarrier();

    // 1.
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint digit = digit_of(key[j]);
        uint lower;
        uint all;
        peers_of(digit, lower, all);
        uint before = pool[row + digit];
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        if (lower == 0u) {
            pool[row + digit] = before + all;
        }
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        place[j] = before + lower;
    }
    barrier();

    // 2.
    uint carry = 0u;
    for (uint group = 0u; group < 256u; group += WORKGROUP) {
        uint digit = group + rank;
        uint sum = 0u;
        if (digit < 256u) {
            for (uint i = 0u; i < gl_NumSubgroups; i++) {
                uint count = pool[i * 256u + digit];
                pool[i * 256u + digit] = sum;
                sum += count;
            }
        }
        uint total;
        uint start = carry + sum_before(sum, total);
        carry += total;
        if (digit < 256u) {
            for (uint i = 0u; i < gl_NumSubgroups; i++) {
                pool[i * 256u + digit] += start;
            }
            // Wraps around below zero, and back when a place in the tile is added.
            digit_base[digit] = starts.at[digit * tiles + tile] - start;
        }
    }
    barrier();
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        place[j] += pool[row + digit_of(key[j])];
    }
    barrier();

    // 3.
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        pool[place[j]] = uint(key[j]);
#if KEY_WORDS == 2
        pool[tile_keys + place[j]] = uint(key[j] >> 32);
#endif
    }
    barrier();
    uint count = min(tile_keys, end - tile_first);
    uint to[ITEMS];
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint i = j * WORKGROUP + rank;
        if (i < count) {
            KEY moved = KEY(pool[i]);
#if KEY_WORDS == 2
            moved |= KEY(pool[tile_keys + i]) << 32;
#endif
            to[j] = digit_base[digit_of(moved)] + i;
            moved_keys.at[to[j]] = moved;
        }
    }
    if (!has_values) {
        return;
    }
    barrier();
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        pool[place[j]] = value[j];
    }
    barrier();
    [[unroll]] for (uint j = 0u; j < ITEMS; j++) {
        uint i = j * WORKGROUP + rank;
        if (i < count) {
            moved_values.at[to[j]] = pool[i];
        }
    }
}
