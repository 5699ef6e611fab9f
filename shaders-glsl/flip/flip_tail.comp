// Whole rounds inside one workgroup, from the claims of one to the claims of the next, while few edges are illegal: so many
// rounds as are allowed, and fewer where nothing is left, or too much. The same rounds as by the wide kernels. The first
// edges of a round's list lie in shared memory with their twins, the others in the lists of the wide kernels.
#version 460
#extension GL_GOOGLE_include_directive : require
#define COHERENT
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    SharedRows triangles;
    SharedRows links;
    ReadPoints positions;
    SharedU32 state;
    SharedU32 illegal_0; // of even rounds
    SharedU32 illegal_1;
    SharedU32 words;
    SharedU32 report;
    uint stride;
    uint scope;
    uint least; // so many illegal edges are left to other kernels, four times as many once it has begun
    uint most; // rounds
    uint most_flips; // illegal edges taken, but for those of the last round
};

// Edges in shared memory, of even and of odd rounds.
const uint NEAR = 1024u;
shared uint near_lower[2u * NEAR];
shared uint near_upper[2u * NEAR];
// Of the rounds after even and after odd ones.
shared uint next_count[2];
shared uint flips;
shared uint tests;

void wait() {
    memoryBarrierBuffer();
    barrier();
}

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint parity = words.at[ILLEGAL_COUNT(0u)] != 0u ? 0u : 1u;
    uint count = words.at[ILLEGAL_COUNT(parity)];
    uint round = words.at[ROUND];
    SharedU32 illegal = illegal_0;
    SharedU32 next_illegal = illegal_1;
    if (parity == 1u) {
        illegal = illegal_1;
        next_illegal = illegal_0;
    }
    for (uint i = rank; i < min(count, NEAR); i += WORKGROUP) {
        uint h = illegal.at[i];
        near_lower[parity * NEAR + i] = h;
        near_upper[parity * NEAR + i] = link_of(links, h);
    }
    if (rank == 0u) {
        flips = 0u;
        tests = 0u;
    }
    barrier();
    uint limit = least;
    uint rounds = 0u;
    uint taken = 0u;
    while (count != 0u && count < limit && rounds < most && taken <= most_flips) {
        limit = min(least, 0x3fffffffu) * 4u;
        rounds++;
        round++;
        taken += count;
        if (rank == 0u) {
            next_count[parity] = 0u;
        }
        for (uint i = rank; i < count; i += WORKGROUP) {
            bool near = i < NEAR;
            uint h = near ? near_lower[parity * NEAR + i] : illegal.at[i];
            uint mine = priority(h);
            // Whoever does not have the first triangle may read what another changes, and does not look at it.
            uint g = near ? near_upper[parity * NEAR + i] : link_of(links, h) & HALF_EDGE;
            bool first = state.at[CLAIM(h, parity)] == mine;
            bool second = state.at[CLAIM(g, parity)] == mine;
            if (first && second) {
                flip_pair(triangles, links, state, stride, round, h, g);
                atomicAdd(flips, 1u);
                if (near) {
                    near_lower[parity * NEAR + i] = h | WON;
                } else {
                    illegal.at[i] = h | WON;
                }
            }
        }
        wait();
        for (uint i = rank; i < 4u * count; i += WORKGROUP) {
            bool near = (i >> 2) < NEAR;
            uint h = near ? near_lower[parity * NEAR + (i >> 2)] : illegal.at[i >> 2];
            uint k = i & 3u;
            bool illegal_edge = false;
            Handed handed;
            handed.some = false;
            if ((h & WON) != 0u) {
                h &= HALF_EDGE;
                uint g = near ? near_upper[parity * NEAR + (i >> 2)] : prev_edge(link_of(links, next_edge(h)));
                if (k < 2u) {
                    state.at[CLAIM(k == 0u ? h : g, parity)] = NONE;
                }
                handed = renew(links, state, stride, round, side_of(h, g, k));
                if (handed.some) {
                    uint b = origin(triangles, handed.side);
                    uint c = destination(triangles, handed.side);
                    if (scope == SCOPE_ALL || b == GHOST || c == GHOST) {
                        atomicAdd(tests, 1u);
                        if (handed.mark == 0u) {
                            uint a = apex(triangles, handed.side);
                            illegal_edge = is_illegal(positions, a, b, c, apex(triangles, handed.outer));
                        }
                    }
                }
            } else if (k == 0u) {
                handed = leave(links, state, stride, parity, round, h);
                if (handed.some) {
                    atomicAdd(tests, 1u);
                    illegal_edge = true;
                }
            }
            if (illegal_edge) {
                uint lower = min(handed.side, handed.outer);
                uint upper = max(handed.side, handed.outer);
                claim(state, stride, parity ^ 1u, lower, upper);
                uint place = atomicAdd(next_count[parity], 1u);
                if (place < NEAR) {
                    near_lower[(parity ^ 1u) * NEAR + place] = lower;
                    near_upper[(parity ^ 1u) * NEAR + place] = upper;
                } else {
                    next_illegal.at[place] = lower;
                }
            }
        }
        wait();
        count = next_count[parity];
        parity ^= 1u;
        SharedU32 other = illegal;
        illegal = next_illegal;
        next_illegal = other;
    }
    for (uint i = rank; i < min(count, NEAR); i += WORKGROUP) {
        illegal.at[i] = near_lower[parity * NEAR + i];
    }
    if (rank == 0u) {
        words.at[ILLEGAL_COUNT(parity)] = count;
        words.at[ILLEGAL_COUNT(parity ^ 1u)] = 0u;
        words.at[PENDING_COUNT] = count;
        words.at[ROUND] = round;
        report.at[REPORT_ROUNDS] += rounds;
        add_wide(report, REPORT_FLIPS, flips);
        add_wide(report, REPORT_TESTS, tests);
    }
}
