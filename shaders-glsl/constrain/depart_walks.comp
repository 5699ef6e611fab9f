// Step 1 of an outer round: each sub-constraint that does not own its whole chain leaves the star of the end with fewer edges.
// One that is an edge becomes a constrained one; the others are listed with the half-edge that they cross first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "appending.glsl"
#include "count.glsl"
#include "steps.glsl"

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32x2 sub_constraints;
    MaybeReadU32 counter; // how many there are, else all
    ReadU32 spokes;
    ReadU32 degrees;
    WriteU32 walkers;
    WriteU32 firsts; // by sub-constraint that walks, the half-edge that it crosses first
    U32 lost;        // by sub-constraint, whether it met another one that has a lower priority
    U32 words;
    uint limit; // sub-constraints that there is room for
    uint most;  // spokes that any turn takes
};

shared uint inserted;

void main() {
    bool first = words.at[OUTER] == 0u;
    bool nobody = words.at[GOES_ON] != 0u || (!first && words.at[WAITED] == 0u);
    uint end = nobody ? 0u : length_of(counter, limit);
    if (gl_LocalInvocationIndex == 0u) {
        inserted = 0u;
    }
    barrier();
    for (uint begin = group_index() * WORKGROUP; begin < end; begin += item_stride()) {
        uint s = begin + gl_LocalInvocationIndex;
        bool walks = false;
        uint h = NONE;
        if (s < end && (first || lost.at[s] != 0u)) {
            lost.at[s] = 0u;
            uvec2 ends = sub_constraints.at[s];
            if (degrees.at[ends.y] < degrees.at[ends.x]) {
                ends = ends.yx;
            }
            uint spoke = spokes.at[ends.x];
            h = edge_to(spoke, ends.y, most, triangles, ReadRows(links));
            if (h != NONE) {
                uint g = twin(links, h);
                set_link(links, h, g | CONSTRAINED);
                set_link(links, g, h | CONSTRAINED);
                atomicAdd(inserted, 1u);
            } else {
                Walker walker = turn_from(spoke, point_at(positions, ends.x), point_at(positions, ends.y));
                uint event = TURNS;
                for (uint step = 0u; step <= most && event == TURNS; step++) {
                    event = advance(walker, triangles, ReadRows(links), positions);
                }
                walks = event == LEAVES;
                h = walker.h;
                if (!walks) {
                    atomicMin(words.at[DEPART_FAULT], s << 2 | (event == ALONG ? THROUGH_VERTEX : ASTRAY));
                }
            }
        }
        uint place = place_in(words, WALKERS, walks);
        if (walks) {
            walkers.at[place] = s;
            firsts.at[s] = h;
        }
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && inserted != 0u) {
        atomicAdd(words.at[INSERTED], inserted);
        if (first) {
            atomicAdd(words.at[EDGES_ALREADY], inserted);
        }
    }
}
