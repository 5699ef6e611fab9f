// Whole rounds inside one workgroup, while few edges are active: as many as `most`, and fewer when an edge is left to do
// nothing with, or too many. The same rounds as by the wide kernels.
#version 460
#extension GL_GOOGLE_include_directive : require
#define WORDS SharedU32
#include "verdict.glsl"

layout(push_constant, std430) uniform Args {
    SharedU32 triangles;
    SharedU32 links;
    ReadPoints positions;
    SharedU32 edges;
    SharedU32 edge_count;
    MaybeWriteU32 also; // another list that edges handed on are appended to
    MaybeU32 also_count;
    SharedU32 illegal;
    SharedU32 claims;
    SharedU32 stamps;
    SharedU32 words;
    SharedU32 report;
    uint scope;
    uint least; // so many active edges are left to other kernels
    uint most; // rounds
    uint most_tests;
    uint also_limit;
};

shared uint illegal_count;
shared uint next_count;
shared uint flips;
shared uint tests;

void wait() {
    memoryBarrierBuffer();
    barrier();
}

void main() {
    uint rank = gl_LocalInvocationIndex;
    uint count = edge_count.at[0];
    uint round = words.at[ROUND];
    if (rank == 0u) {
        flips = 0u;
        tests = 0u;
        illegal_count = 0u;
    }
    wait();
    uint limit = least;
    uint rounds = 0u;
    uint taken = 0u;
    while (count != 0u && count < limit && rounds < most && taken <= most_tests) {
        limit = min(least, 0x3fffffffu) * 4u;
        rounds++;
        round++;
        taken += count;
        for (uint i = rank; i < count; i += WORKGROUP) {
            uint h = edges.at[i];
            if (scope == SCOPE_ALL || is_ghost_edge(triangles, h)) {
                atomicAdd(tests, 1u);
                if (verdict(triangles, links, positions, h) == ILLEGAL) {
                    claim(claims, h, twin(links, h));
                    illegal.at[atomicAdd(illegal_count, 1u)] = h;
                }
            }
        }
        wait();
        uint end = illegal_count;
        if (rank == 0u) {
            next_count = 0u;
        }
        for (uint i = rank; i < end; i += WORKGROUP) {
            uint h = illegal.at[i];
            if (flip_if_won(triangles, links, claims, stamps, round, h)) {
                illegal.at[i] = h | WON;
                atomicAdd(flips, 1u);
            }
        }
        wait();
        if (rank == 0u) {
            illegal_count = 0u;
        }
        for (uint i = rank; i < end; i += WORKGROUP) {
            uint h = illegal.at[i];
            Handed handed;
            if ((h & WON) != 0u) {
                handed = relink(triangles, links, claims, stamps, round, h & HALF_EDGE);
            } else {
                handed = leave(links, claims, stamps, round, h);
            }
            uint place = atomicAdd(next_count, handed.count);
            uint behind = present(also) && handed.count != 0u ? atomicAdd(also_count.at[0], handed.count) : 0u;
            for (uint k = 0u; k < handed.count; k++) {
                edges.at[place + k] = handed.edges[k];
                if (present(also) && behind + k < also_limit) {
                    also.at[behind + k] = handed.edges[k];
                }
            }
        }
        wait();
        count = next_count;
    }
    if (rank == 0u) {
        edge_count.at[0] = count;
        words.at[ROUND] = round;
        report.at[REPORT_ROUNDS] += rounds;
        add_wide(report, REPORT_FLIPS, flips);
        add_wide(report, REPORT_TESTS, tests);
    }
}
