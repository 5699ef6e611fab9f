// Which constraints are edges: found by the numbers of vertices alone. The others are listed. A walk begins at the end with
// fewer edges, of two like ones at the first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"
#include "workgroup_scan.glsl"
#include "edge_to.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadU32x2 ends;
    ReadU32 spokes;
    ReadU32 degrees;
    WriteU32 met;
    WriteU32 lengths; // how many vertices the chain has, or NONE; behind them a zero
    WriteU32 list;
    U32 words;
    uint constraints;
};

// Spokes that are looked at. Those of a vertex with more are looked at by their sides, which also finds edges.
const uint MOST_SPOKES = 64u;

shared uint place_of_group;

void main() {
    uint c = item_index();
    bool walks = false;
    if (c < constraints) {
        uvec2 both = ends.at[c];
        uint length = 1u;
        bool reversed = false;
        if (both.x != both.y) {
            reversed = degrees.at[both.y] < degrees.at[both.x];
            uint spoke = spokes.at[reversed ? both.y : both.x];
            if (spoke == NONE) {
                atomicMin(words.at[LOST_WALK], c);
            } else {
                walks = edge_to(spoke, reversed ? both.x : both.y, MOST_SPOKES, triangles, links) == NONE;
            }
            length = walks ? NONE : 2u;
        }
        met.at[c] = reversed ? REVERSED : 0u;
        lengths.at[c] = length;
    } else if (c == constraints) {
        lengths.at[c] = 0u;
    }
    uint total;
    uint before = sum_before(uint(walks), total);
    if (gl_LocalInvocationIndex == 0u && total != 0u) {
        place_of_group = atomicAdd(words.at[NEXT], total);
    }
    barrier();
    if (walks) {
        list.at[place_of_group + before] = c;
    }
}
