// The end of an outer round, in one workgroup. While few pairs may be flipped it makes the inner rounds that are left of this
// outer round, from the claims of one to the claims of the next: the same rounds as by the wide kernels. Then it turns to the
// next outer round, or has the inner rounds go on.
#version 460
#extension GL_GOOGLE_include_directive : require
#define COHERENT
#include "candidates.glsl"

layout(push_constant, std430) uniform Args {
    SharedRows triangles;
    SharedRows links;
    ReadPoints positions;
    SharedU32 state;
    SharedU32x2 even_pairs;
    SharedU32x2 odd_pairs;
    SharedU32 spokes;
    SharedU32 degrees;
    MaybeReadU32 counter; // how many sub-constraints there are, else all
    SharedU32 words;
    uint limit;      // sub-constraints that there is room for
    uint least;      // so many pairs are left to other kernels, four times as many once it has begun
    uint most;       // rounds
    uint most_pairs; // pairs taken, but for those of the last round
    uint inner;      // inner rounds of an outer round,
    uint long_chain; // once more for so many triangles of an average walk
    uint most_times;
    uint usual_rounds; // and for so many outer rounds before
};

shared uint flips[4];
shared uint next_count;

void wait() {
    memoryBarrierBuffer();
    barrier();
}

// How many inner rounds this outer round has, when all of it is marked.
uint limit_of_round() {
    if (words.at[LOSERS] == 0u) {
        return NONE;
    }
    uint64_t before = packUint2x32(uvec2(words.at[WALKED_BEFORE], words.at[WALKED_BEFORE + 1u]));
    uint64_t walked = packUint2x32(uvec2(words.at[WALKED], words.at[WALKED + 1u])) - before;
    uint64_t walkers = uint64_t(max(words.at[ADMITTED], 1u));
    uint64_t late = uint64_t(words.at[OUTER_ROUNDS] / usual_rounds);
    uint64_t times = 1ul + max(walked / (uint64_t(long_chain) * walkers), late);
    return inner * uint(min(times, uint64_t(most_times)));
}

// What the next outer round finds; by one invocation.
void turn() {
    uint outer = words.at[OUTER];
    uint waited = words.at[WAITED];
    if (outer == 0u) {
        waited = 1u;
        for (uint i = 0u; i < 2u; i++) {
            words.at[INTERSECTIONS + i] = words.at[WALKED + i];
        }
    }
    uint losers = words.at[LOSERS];
    words.at[WAITED] = losers;
    words.at[LOSERS] = 0u;
    words.at[OUTER_ROUNDS] += uint(waited != 0u);
    words.at[INNER] = 0u;
    words.at[ROUND] += 2u;
    words.at[OUTER] = outer + 1u;
    for (uint i = 0u; i < 2u; i++) {
        words.at[WALKED_BEFORE + i] = words.at[WALKED + i];
    }
}

// What is left; by one invocation.
void look(bool goes_on, bool fails) {
    uint count = limit;
    if (present(counter)) {
        count = min(counter.at[0], limit);
    }
    // Each round flips something, or makes an edge of something, or has someone walk farther the next time.
    uint progress = words.at[INSERTED] + words.at[PARTIAL_WALKS];
    for (uint kind = 0u; kind < 3u; kind++) {
        progress += words.at[FLIPS + 2u * kind];
    }
    uint left = count - words.at[INSERTED];
    if (left != 0u && !fails && progress == words.at[PROGRESS]) {
        words.at[STUCK] = 1u;
    }
    words.at[PROGRESS] = progress;
    words.at[MARKED] = 0u;
    words.at[WALKERS] = 0u;
    words.at[ADMITTED] = 0u;
    words.at[GOES_ON] = uint(goes_on);
    words.at[LEFT] = fails || words.at[STUCK] != 0u ? 0u : left;
}

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint round = words.at[ROUND];
    uint parity = round & 1u;
    uint count = words.at[CANDIDATES + parity];
    bool fails = has_failed(words);
    uint before = words.at[INNER];
    uint inner_limit = words.at[GOES_ON] == 0u ? limit_of_round() : words.at[INNER_LIMIT];
    uint left = fails ? 0u : min(inner_limit - min(before, inner_limit), most);
    uint room = least;
    if (rank < 4u) {
        flips[rank] = 0u;
    }
    barrier();
    uint rounds = 0u;
    uint taken = 0u;
    while (count != 0u && count < room && rounds < left && taken <= most_pairs && !fails) {
        room = min(least, 0x3fffffffu) * 4u;
        rounds++;
        round++;
        taken += min(count, NONE - taken);
        uint held = held_pairs(words, round);
        if (rank == 0u) {
            next_count = 0u;
        }
        for (uint i = rank; i < count; i += WORKGROUP) {
            uvec2 entry = pairs_of(parity).at[i];
            if (wins(links, state, parity, entry, i < held ? round - 1u : NONE)) {
                uint done = flip_pair(triangles, links, state, spokes, degrees, words, round, entry.x);
                if (done == INSERTS) {
                    atomicAdd(flips[3], 1u);
                }
                if (done != IS_BLOCKED) {
                    pairs_of(parity).at[i].x = entry.x | WON;
                    atomicAdd(flips[entry.y >> CLAIM_BITS], 1u);
                }
            }
        }
        wait();
        for (uint i = rank; i < 4u * count; i += WORKGROUP) {
            uvec2 entry = pairs_of(parity).at[(i >> 2)];
            Look look = settle(links, state, parity, round, entry, i & 3u);
            Candidate found = NO_PAIR;
            if (i >> 2 >= held) {
                found = look.known;
            }
            if (look.a != NONE && found.a == NONE) {
                found = candidate(triangles, links, positions, state, round, look.a);
            }
            renew(links, look);
            if (found.a != NONE) {
                claim(state, parity ^ 1u, found);
                pairs_of(parity ^ 1u).at[atomicAdd(next_count, 1u)] = found.entry;
            }
        }
        wait();
        count = next_count;
        parity ^= 1u;
        fails = has_failed(words);
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
        words.at[INNER_ROUNDS] += rounds;
        words.at[INNER] = before + rounds;
        words.at[INNER_LIMIT] = inner_limit;
        bool goes_on = count != 0u && before + rounds < inner_limit && !fails;
        if (!goes_on) {
            turn();
        }
        look(goes_on, fails);
    }
}
