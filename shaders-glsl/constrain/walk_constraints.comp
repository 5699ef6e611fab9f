// The constraints walk the mesh, and meet the vertices at which they are cut.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"
#include "steps.glsl"
#extension GL_KHR_shader_subgroup_ballot : require

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadRows links;
    ReadPoints positions;
    ReadU32x2 ends;
    ReadU32 spokes;
    U32 met;        // by constraint: see MET
    U32 lengths;    // by constraint: how many vertices its chain has; NONE while it walks
    ReadU32 runs;   // by constraint: where its later pieces stand, or NONE
    U32x4 pieces;
    U32 piece_met;  // by later piece: how many vertices it met
    WriteU32 stops; // by vertex met: the item, its number there, and the vertex
    U32 state;
    U32 words;
    uint constraints;
    uint piece_limit;
    uint stop_limit;
    uint most; // steps in a dispatch
};

// Appends a vertex met; one access for all invocations of a subgroup that do so together.
void meet(uint item, uint number, uint vertex) {
    uvec4 together = subgroupBallot(true);
    uint place = 0u;
    if (subgroupElect()) {
        bool full = words.at[STOPS] >= MOST_STOPS;
        place = full ? MOST_STOPS : atomicAdd(words.at[STOPS], subgroupBallotBitCount(together));
    }
    place = subgroupBroadcastFirst(place) + subgroupBallotExclusiveBitCount(together);
    if (place < stop_limit) {
        stops.at[3u * place] = item;
        stops.at[3u * place + 1u] = number;
        stops.at[3u * place + 2u] = vertex;
    }
}

void main() {
    uint i = item_index();
    if (i >= words.at[WAITING]) {
        return;
    }
    uint items = constraints + piece_limit;
    bool fresh = words.at[ROUND] == 0u;
    uint walkers = words.at[WALKERS];
    uint item = fresh && i >= walkers ? constraints + (i - walkers) : state.at[list_now(words, items) + i];

    if (item == NO_ITEM) {
        return;
    }

    // The pieces from `p` up to `end` are those after this one.
    bool later = item >= constraints;
    uint c = item;
    uint piece = 0u;
    uint run = NONE;
    uint p = 0u;
    uint end = 0u;
    uint beginning = NONE;
    if (later) {
        p = item - constraints;
        uvec4 words_of = pieces.at[p];
        c = words_of.x;
        piece = piece_number(words_of);
        beginning = words_of.z;
        run = first_piece(words_of, p);
        end = pieces_end(words_of, run);
        p++;
    } else {
        run = runs.at[c];
        if (run != NONE) {
            p = run;
            end = pieces_end(pieces.at[run], run);
        }
    }
    uint until = next_beginning(pieces, p, end);
    uvec2 both = ends.at[c];
    uint number = later ? 0u : met.at[c];
    bool reversed = ((later ? met.at[c] : number) & REVERSED) != 0u;
    uint mark = number & ~MET;
    number &= MET;
    uint from = reversed ? both.y : both.x;
    uint to = reversed ? both.x : both.y;

    uint h = beginning;
    bool crosses = later && (beginning & AT_VERTEX) == 0u;
    bool done = false;
    if (!fresh) {
        h = state.at[item];
        crosses = (h & CROSSES) != 0u;
        h &= HALF_EDGE;
        number = later ? piece_met.at[item - constraints] : number;
    } else if (later) {
        done = h == NONE || h == until;
        if (!done && !crosses) {
            uint vertex = h & HALF_EDGE;
            meet(item, number, vertex);
            number++;
            h = spokes.at[vertex];
        }
    } else {
        h = spokes.at[from];
    }

    if (!done) {
        Point a = point_at(positions, from);
        Point b = point_at(positions, to);
        Walker walker = turn_from(h, a, b);
        if (crosses) {
            walker.state = CROSSING;
        }
        bool at_end = false;
        for (uint step = 0u; step < most && !done; step++) {
            uint event = advance(walker, triangles, links, positions);
            if (event == LEAVES) {
                done = walker.h == until;
            } else if (event == ALONG || event == AT_APEX) {
                uint vertex = event == ALONG ? destination(triangles, walker.h) : apex(triangles, walker.h);
                at_end = vertex == to;
                done = at_end || until == (AT_VERTEX | vertex);
                if (!done) {
                    meet(item, number, vertex);
                    number++;
                    turn_again(walker, event, links);
                }
            } else if (event == LOST) {
                atomicMin(words.at[LOST_WALK], c);
                done = true;
            }
        }
        if (at_end && run != NONE) {
            atomicMin(pieces.at[run].w, piece);
        }
        h = walker.h | (walker.state == CROSSING ? CROSSES : 0u);
    }

    if (later) {
        piece_met.at[item - constraints] = number;
    } else {
        met.at[c] = number | mark;
    }
    if (!done) {
        state.at[item] = h;
        state.at[list_next(words, items) + atomicAdd(words.at[NEXT], 1u)] = item;
    } else if (!later) {
        lengths.at[c] = number + 2u;
    }
}
