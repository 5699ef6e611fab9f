// Whole rounds inside one workgroup, from the claims of one to the claims of the next, while few edges are illegal: so many
// rounds as are allowed, and fewer where nothing is left, or too much. The same rounds as by the wide kernels. The first
// edges of a round's list lie in shared memory, the others in the lists of the wide kernels.
#version 460
#extension GL_GOOGLE_include_directive : require
#define COHERENT
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    SharedRows triangles;
    SharedRows links;
    ReadPoints positions;
    SharedU32 claims;
    SharedU32x2 illegal_0; // of even rounds
    SharedU32x2 illegal_1;
    SharedU32 words;
    SharedU32 report;
    uint scope;
    uint least; // so many illegal edges are left to other kernels, four times as many once it has begun
    uint most; // rounds
    uint most_flips; // illegal edges taken, but for those of the last round
};

// Edges in shared memory, of even and of odd rounds.
const uint NEAR = 1024u;
shared uvec2 near_edges[2u * NEAR];
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
    SharedU32x2 illegal = illegal_0;
    SharedU32x2 next_illegal = illegal_1;
    if (parity == 1u) {
        illegal = illegal_1;
        next_illegal = illegal_0;
    }
    for (uint i = rank; i < min(count, NEAR); i += WORKGROUP) {
        near_edges[parity * NEAR + i] = illegal.at[i];
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
            uvec2 edge = near ? near_edges[parity * NEAR + i] : illegal.at[i];
            if (flip_pair(triangles, links, claims, round, edge)) {
                atomicAdd(flips, 1u);
                if (near) {
                    near_edges[parity * NEAR + i].x = edge.x | WON;
                } else {
                    illegal.at[i].x = edge.x | WON;
                }
            }
        }
        wait();
        for (uint i = rank; i < 4u * count; i += WORKGROUP) {
            bool near = (i >> 2) < NEAR;
            uvec2 edge = near ? near_edges[parity * NEAR + (i >> 2)] : illegal.at[i >> 2];
            uint k = i & 3u;
            bool illegal_edge = false;
            Handed handed;
            handed.some = false;
            if ((edge.x & WON) != 0u) {
                edge.x &= HALF_EDGE;
                uint side = side_of(edge, k);
                uint t = side / 3u;
                uint at = side - 3u * t;
                uvec4 row = FOUR_WORDS(triangles)[2u * t].row;
                handed = look_out(links, round, side);
                uint d = apex(triangles, handed.outer);
                renew(links, handed);
                uint b = pick(row, turned(at, 1u));
                uint c = pick(row, turned(at, 2u));
                if (handed.some && (scope == SCOPE_ALL || b == GHOST || c == GHOST)) {
                    atomicAdd(tests, 1u);
                    if (handed.mark == 0u) {
                        illegal_edge = is_illegal(positions, pick(row, at), b, c, d);
                    }
                }
            } else if (k == 0u) {
                handed = leave(links, round, edge);
                if (handed.some) {
                    atomicAdd(tests, 1u);
                    illegal_edge = true;
                }
            }
            if (illegal_edge) {
                uvec2 next = uvec2(min(handed.side, handed.outer), max(handed.side, handed.outer));
                claim(claims, next.x, next.y);
                uint place = atomicAdd(next_count[parity], 1u);
                if (place < NEAR) {
                    near_edges[(parity ^ 1u) * NEAR + place] = next;
                } else {
                    next_illegal.at[place] = next;
                }
            }
        }
        wait();
        count = next_count[parity];
        parity ^= 1u;
        SharedU32x2 other = illegal;
        illegal = next_illegal;
        next_illegal = other;
    }
    for (uint i = rank; i < min(count, NEAR); i += WORKGROUP) {
        illegal.at[i] = near_edges[parity * NEAR + i];
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
