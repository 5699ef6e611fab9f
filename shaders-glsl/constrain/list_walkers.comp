// Which sub-constraints are to walk in an outer round: those that do not own their whole chain. In the first round all that are no
// edges; those that are become constrained ones. It also counts how many end at each vertex.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "appending.glsl"
#include "count.glsl"
#include "edge_to.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadU32x2 sub_constraints;
    MaybeReadU32 counter; // how many there are, else all
    ReadU32 spokes;
    ReadU32 degrees;
    WriteU32 walkers;
    U32 lost;   // by sub-constraint
    U32 counts; // by vertex, zeros before: how many that walk end there, up to `crowd` or some more
    U32 words;
    uint limit; // sub-constraints that there is room for
    uint most;  // spokes that any turn takes
    uint crowd;
};

shared uint inserted;

void main() {
    bool first = words.at[OUTER] == 0u;
    bool nobody = has_failed(words) || words.at[GOES_ON] != 0u || (!first && words.at[WAITED] == 0u);
    uint end = nobody ? 0u : length_of(counter, limit);
    if (gl_LocalInvocationIndex == 0u) {
        inserted = 0u;
    }
    if (item_index() == 0u) {
        uint round = words.at[ROUND];
        words.at[STOLEN] = 0u;
        words.at[HELD] = words.at[CANDIDATES + (round & 1u)];
        words.at[HELD_ROUND] = nobody ? NONE : round;
    }
    barrier();
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint s = begin + gl_LocalInvocationIndex;
        bool walks = false;
        if (s < end && first) {
            uvec2 ends = sub_constraints.at[s];
            bool reversed = degrees.at[ends.y] < degrees.at[ends.x];
            uint spoke = spokes.at[reversed ? ends.y : ends.x];
            uint h = edge_to(spoke, reversed ? ends.x : ends.y, most, triangles, ReadRows(links));
            walks = h == NONE;
            lost.at[s] = walks ? 0u : DONE;
            if (walks) {
                for (uint k = 0u; k < 2u; k++) {
                    if (counts.at[ends[k]] < crowd) {
                        atomicAdd(counts.at[ends[k]], 1u);
                    }
                }
            } else {
                uint g = twin(links, h);
                set_link(links, h, g | CONSTRAINED);
                set_link(links, g, h | CONSTRAINED);
                atomicAdd(inserted, 1u);
            }
        } else if (s < end) {
            uint known = lost.at[s];
            walks = (known & LOSES) != 0u;
            if (walks) {
                lost.at[s] = known & ((known & AT_HUB) != 0u ? ~(LOSES | BARRED) : LONG);
            } else if ((known & (BY_FLIPS | BARRED)) == 0u && known != DONE) {
                lost.at[s] = DONE;
            }
        }
        uint place = place_in(words, WALKERS, walks);
        if (walks) {
            walkers.at[place] = s;
        }
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && inserted != 0u) {
        atomicAdd(words.at[INSERTED], inserted);
        atomicAdd(words.at[EDGES_ALREADY], inserted);
    }
}
