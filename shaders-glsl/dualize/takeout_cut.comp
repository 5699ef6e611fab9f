// Take out: cuts ears off the star of each site that goes, and merges what is left, or moves the site to infinity if it is
// on the hull. Nothing outside the star is touched; where its outer edges have gone is noted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "takeout.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    U32 triangles;
    U32 links;
    ReadPoints positions;
    U32 state;
    U32 winners;  // half-edges to heirs; deferred ones: where to go on
    U32 deferred;
    U32 freed;    // two slots for each site
    U32 edge_of;
    OuterEdges edges;
    U32 words;
    uint round; // of the batch
    uint again; // whether the deferred ones are to be decided
};

// The outer edge, or the edge of an ear, at `from` goes to `to`, in another triangle of the same star.
void move_edge(uint from, uint to) {
    uint across = links.at[from];
    uint entry = edge_of.at[from / 3u];
    links.at[to] = across;
    if (edges.at[entry].y == from) {
        edges.at[entry].y = to;
    } else {
        links.at[across] = to;
    }
}

void flip_spoke(uint h, uint g) {
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint before = links.at[g1];
    triangles.at[prev_edge(h)] = triangles.at[g];
    triangles.at[prev_edge(g)] = triangles.at[h];
    link(links, h, before);
    move_edge(h1, g);
    link(links, h1, g1);
}

void free_two(uint v, uint t, uint u) {
    free_slot(triangles, links, t);
    free_slot(triangles, links, u);
    freed.at[2u * v] = t;
    freed.at[2u * v + 1u] = u;
}

void merge(uint v, uint h) {
    uint ccw = rotate_ccw(links, h);
    uint cw = rotate_cw(links, h);
    triangles.at[next_edge(h)] = destination(triangles, cw);
    move_edge(next_edge(ccw), prev_edge(h));
    move_edge(next_edge(cw), h);
    free_two(v, ccw / 3u, cw / 3u);
}

void to_infinity(uint v, uint h) {
    uint to_ghost = rotate_ccw(links, h);
    uint start = rotate_ccw(links, to_ghost);
    uint end = twin(links, h);
    uint spoke = start;
    for (uint step = 0u; spoke != h && step < MOST_TRIANGLES_OF_STAR; step++) {
        triangles.at[next_edge(spoke)] = GHOST;
        spoke = rotate_ccw(links, spoke);
    }
    move_edge(next_edge(h), end);
    move_edge(next_edge(to_ghost), start);
    free_two(v, h / 3u, to_ghost / 3u);
}

// The number of triangles around the origin of `start`, and the half-edge to the ghost if there is one.
uint look_around(uint start, out uint to_ghost) {
    to_ghost = NONE;
    uint degree = 0u;
    uint h = start;
    do {
        if (destination(triangles, h) == GHOST) {
            to_ghost = h;
        }
        h = rotate_ccw(links, h);
        degree++;
    } while (h != start && degree < MOST_TRIANGLES_OF_STAR);
    return degree;
}

void list_edges(uint start, uint degree) {
    uint first = atomicAdd(words.at[OUT_EDGES + round], degree);
    uint h = start;
    for (uint i = 0u; i < degree; i++) {
        edges.at[first + i] = uvec2(h / 3u, next_edge(h));
        edge_of.at[h / 3u] = first + i;
        h = rotate_ccw(links, h);
    }
}

void main() {
    uint count = words.at[(again != 0u ? OUT_DEFERRED : OUT_WINNERS) + round];
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint h = again != 0u ? deferred.at[i] : winners.at[i];
        uint v = origin(triangles, h);
        uint to_ghost;
        uint left = look_around(h, to_ghost);
        if (again == 0u) {
            list_edges(h, left);
            state.at[v] = destination(triangles, h);
            h = to_ghost == NONE ? h : rotate_ccw(links, to_ghost);
        }
        uvec4 at = positions.at[v];
        uint most = 4u * left;
        uint step = 0u;
        for (; step < most; step++) {
            if (to_ghost == NONE && left == 3u) {
                merge(v, h);
                break;
            }
            uint b = apex(triangles, h);
            if (b == GHOST) {
                to_infinity(v, h);
                break;
            }
            uint g = twin(links, h);
            uint a = apex(triangles, g);
            bool is_ear = false;
            if (a != GHOST) {
                uvec4 at_a = positions.at[a];
                uvec4 at_b = positions.at[b];
                uvec4 at_l = positions.at[destination(triangles, h)];
                // Both signs by one call: a l b and a b v.
                int signs[2];
                for (uint k = 0u; k < 2u; k++) {
                    signs[k] = orient2d(at_a, k == 0u ? at_l : at_b, k == 0u ? at_b : at);
                }
                if (signs[0] == UNDECIDED && signs[1] != -1 || signs[1] == UNDECIDED && signs[0] == 1) {
                    deferred.at[append(words, OUT_DEFERRED + round)] = h;
                    break;
                }
                is_ear = signs[0] == 1 && signs[1] != -1;
            }
            if (is_ear) {
                flip_spoke(h, g);
                left--;
            } else {
                h = rotate_ccw(links, h);
            }
        }
        if (step == most) {
            note_broken(words, v);
        }
    }
}
