// The end of an outer round, in one workgroup. While few pairs may be flipped it makes the inner rounds that are left of this
// outer round, from the claims of one to the claims of the next: the same rounds as by the wide kernels. If each
// sub-constraint that is not in yet owns its whole chain, it goes on as far as it is allowed to. Then it turns to the next
// outer round.
#version 460
#extension GL_GOOGLE_include_directive : require
#define COHERENT
#include "candidates.glsl"

layout(push_constant, std430) uniform Args {
    SharedU32 triangles;
    SharedU32 links;
    ReadPoints positions;
    SharedU32 owner;
    SharedU32 state;
    SharedU32x2 pairs;
    SharedU32 spokes;
    SharedU32 degrees;
    MaybeReadU32 counter; // how many sub-constraints there are, else all
    SharedU32 words;
    uint stride;
    uint limit;       // sub-constraints that there is room for
    uint inner;       // inner rounds of an outer round
    uint least;       // so many pairs are left to other kernels, four times as many once it has begun
    uint most;        // rounds
    uint most_pairs;  // pairs taken, but for those of the last round
};

shared uint flips[4];
shared uint next_count;

void wait() {
    memoryBarrierBuffer();
    barrier();
}

// What the next outer round finds; by one invocation.
void turn(uint rounds) {
    uint outer = words.at[OUTER];
    uint count = limit;
    if (present(counter)) {
        count = min(counter.at[0], limit);
    }
    uint waited = outer == 0u ? count : words.at[WAITED];
    uint losers = words.at[LOSERS];
    words.at[WAITED] = losers;
    words.at[LOSERS] = 0u;
    words.at[WALKERS + (outer & 1u)] = 0u;
    if (losers == 0u) {
        words.at[WALKERS + (outer & 1u ^ 1u)] = 0u;
    }
    words.at[OUTER_ROUNDS] += uint(waited != 0u);
    words.at[INNER_ROUNDS] += rounds;
    words.at[INNER] = 0u;
    words.at[MARKED] = 0u;
    words.at[ROUND] += 2u;
    words.at[OUTER] = outer + 1u;
    if (outer == 0u) {
        words.at[INTERSECTIONS] = words.at[WALKED];
        words.at[INTERSECTIONS + 1u] = words.at[WALKED + 1u];
    }
    // Each round flips something, or makes an edge of something.
    uint progress = words.at[INSERTED];
    for (uint kind = 0u; kind < 3u; kind++) {
        progress += words.at[FLIPS + 2u * kind];
    }
    uint left = count - words.at[INSERTED];
    bool fails = words.at[DEPART_FAULT] != NONE || words.at[WALK_FAULT] != NONE;
    if (left != 0u && !fails && progress == words.at[PROGRESS]) {
        words.at[STUCK] = 1u;
    }
    words.at[PROGRESS] = progress;
    words.at[LEFT] = fails || words.at[STUCK] != 0u ? 0u : left;
}

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint round = words.at[ROUND];
    uint parity = round & 1u;
    uint count = words.at[CANDIDATES + parity];
    bool fails = words.at[DEPART_FAULT] != NONE || words.at[WALK_FAULT] != NONE;
    bool to_the_end = words.at[LOSERS] == 0u;
    uint left = fails ? 0u : to_the_end ? most : inner - min(words.at[INNER], inner);
    uint room = to_the_end ? least : NONE;
    uint limit_of_taken = to_the_end ? most_pairs : NONE;
    if (rank < 4u) {
        flips[rank] = 0u;
    }
    barrier();
    uint rounds = 0u;
    uint taken = 0u;
    while (count != 0u && count < room && rounds < left && taken <= limit_of_taken) {
        room = min(room, 0x3fffffffu) * 4u;
        rounds++;
        round++;
        taken += min(count, NONE - taken);
        if (rank == 0u) {
            next_count = 0u;
        }
        for (uint i = rank; i < count; i += WORKGROUP) {
            uvec2 entry = pairs.at[parity * stride + i];
            if (wins(links, state, stride, parity, entry)) {
                if (flip_pair(triangles, links, owner, state, spokes, degrees, stride, round, entry.x)) {
                    atomicAdd(flips[3], 1u);
                }
                pairs.at[parity * stride + i].x = entry.x | WON;
                atomicAdd(flips[entry.y >> CLAIM_BITS], 1u);
            }
        }
        wait();
        for (uint i = rank; i < 4u * count; i += WORKGROUP) {
            uvec2 entry = pairs.at[parity * stride + (i >> 2)];
            Look look = settle(links, owner, state, stride, parity, round, entry, i & 3u);
            Candidate found = look.known;
            if (look.a != NONE && found.a == NONE) {
                found = candidate(triangles, links, positions, owner, state, stride, round, look.a);
            }
            if (found.a != NONE) {
                claim(state, stride, parity ^ 1u, found);
                pairs.at[(parity ^ 1u) * stride + atomicAdd(next_count, 1u)] = found.entry;
            }
        }
        wait();
        count = next_count;
        parity ^= 1u;
        wait();
    }
    if (rank == 0u) {
        words.at[CANDIDATES + parity] = count;
        words.at[CANDIDATES + (parity ^ 1u)] = 0u;
        words.at[ROUND] = round;
        words.at[INSERTED] += flips[3];
        for (uint kind = 0u; kind < 3u; kind++) {
            add_wide(words, FLIPS + 2u * kind, flips[kind]);
        }
        turn(rounds);
    }
}
