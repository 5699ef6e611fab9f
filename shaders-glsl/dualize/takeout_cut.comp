// Take out: cuts ears off the star of each site that goes, and merges what is left, or moves the site to infinity if it is
// on the hull. Nothing outside the star is touched; where its outer edges have gone is noted.
//
// Ears are cut in passes, in each all that have no ear beside them of lower priority: `pass` of the reference. The filter
// takes small stars, each by one invocation: it reads all of one, decides on all cuts, and then writes. Where it is
// undecided, or the star is large, the other kernel takes the star by a workgroup, an invocation for each spoke. Stars larger
// than shared memory are cut step by step in the mesh: `scan` of the reference.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "takeout.glsl"
#include "predicates.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadPoints positions;
    U32 state;
    U32 winners;  // half-edges to heirs
    U32 deferred; // those that the other kernel takes
    U32 freed;    // two slots for each site
    U32 edge_of;
    OuterEdges edges;
    U32 words;
    uint round; // of the batch
    uint again; // whether the deferred ones are to be taken
};

bool is_decided_ear(uvec4 at, uvec4 a, uvec4 l, uvec4 b, out bool is_ear) {
    // Both signs by one call: a l b must be 1, and a b v not be -1.
    bool decided = true;
    [[dont_unroll]] for (uint k = 0u; k < 2u; k++) {
        int sign = orient2d(a, k == 0u ? l : b, k == 0u ? b : at);
        decided = decided && sign != UNDECIDED;
        if (sign == -1 || k == 0u && sign == 0) {
            is_ear = false;
            return true;
        }
    }
    is_ear = decided;
    return decided;
}

void free_two(uint v, uint t, uint u) {
    free_slot(triangles, links, t);
    free_slot(triangles, links, u);
    freed.at[2u * v] = t;
    freed.at[2u * v + 1u] = u;
}

// The star of a site, in arrays.

const uint MOST = 16u;

uint spokes[MOST];
uint ends[MOST];    // of spokes
uvec4 where[MOST];  // the ends are
uint across[MOST];  // the outer edge of each spoke's triangle
uint places[MOST];  // of the triangle's first outer edge
uint inside;        // bits of triangles whose outer edge by now is that of an ear
// For each spoke four bits: the next and the previous one, and whose end it has.
uint64_t following;
uint64_t preceding;
uint64_t end_of;

uint bits(uint64_t of, uint k) {
    return uint(of >> (4u * k)) & 15u;
}

void set_bits(inout uint64_t of, uint k, uint value) {
    of = of & ~(15ul << (4u * k)) | uint64_t(value) << (4u * k);
}

void make_ring(uint degree) {
    following = 0ul;
    preceding = 0ul;
    end_of = 0xfedcba9876543210ul;
    for (uint k = 0u; k < degree; k++) {
        set_bits(following, k, k + 1u == degree ? 0u : k + 1u);
        set_bits(preceding, k, k == 0u ? degree - 1u : k - 1u);
    }
}

// The spoke c now has the end of the one before, which leaves the ring.
void drop_before(uint c) {
    uint a = bits(preceding, c);
    uint before = bits(preceding, a);
    set_bits(end_of, c, bits(end_of, a));
    set_bits(preceding, c, before);
    set_bits(following, before, c);
}

// The outer edge of the triangle of spoke c goes to `to`.
void place_edge(uint c, uint to) {
    set_link(links, to, across[c]);
    if ((inside >> c & 1u) != 0u) {
        set_link(links, across[c], to);
    } else {
        places[c] = to;
    }
}

// Whether the ear of spoke k comes before that of another spoke, if that has one.
bool is_first(uint ears, uint k, uint other) {
    return (ears >> other & 1u) == 0u || priority(ends[bits(end_of, k)]) < priority(ends[bits(end_of, other)]);
}

// Cuts the star whose spokes and ends are in the arrays; or does nothing and returns false.
bool cut_small(uint v, uint degree, uint ghost) {
    uvec4 at = positions.at[v];
    for (uint first = 0u; first < degree; first += STEPS) {
        uvec4 at_end[STEPS];
        uint beyond[STEPS];
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            uint i = min(first + k, degree - 1u);
            at_end[k] = positions.at[ends[i] < DELETED ? ends[i] : v];
            beyond[k] = link_of(links, next_edge(spokes[i]));
        }
        [[unroll]] for (uint k = 0u; k < STEPS; k++) {
            where[first + k] = at_end[k];
            across[first + k] = beyond[k];
        }
    }
    make_ring(degree);
    bool is_inner = ghost == NONE;
    uint64_t cuts = 0ul;
    uint cut_count = 0u;
    uint left = degree;
    uint stays = (1u << degree) - 1u;
    uint open = stays; // spokes to be tested
    uint ears = 0u;
    for (uint step = 0u; step < MOST && (!is_inner || left != 3u); step++) {
        for (uint k = 0u; k < degree; k++) {
            if ((open >> k & 1u) != 0u) {
                uint a = bits(preceding, k);
                uint b = bits(following, k);
                bool is_ear = false;
                if (k != ghost && a != ghost && b != ghost) {
                    if (!is_decided_ear(at, where[bits(end_of, a)], where[bits(end_of, k)], where[bits(end_of, b)], is_ear)) {
                        return false;
                    }
                }
                ears = ears & ~(1u << k) | uint(is_ear) << k;
            }
        }
        uint cut = 0u;
        for (uint k = 0u; k < degree; k++) {
            if ((ears >> k & 1u) != 0u) {
                uint b = bits(following, k);
                bool first = is_first(ears, k, bits(preceding, k)) && is_first(ears, k, b);
                first = first && (!is_inner || left != 4u || is_first(ears, k, bits(following, b)));
                cut |= uint(first) << k;
            }
        }
        if (cut == 0u) {
            break;
        }
        open = 0u;
        for (uint k = 0u; k < degree; k++) {
            if ((cut >> k & 1u) != 0u) {
                cuts |= uint64_t(k) << (4u * cut_count);
                cut_count++;
                stays &= ~(1u << bits(preceding, k));
                drop_before(k);
                left--;
                open |= 1u << k | 1u << bits(following, k);
            }
        }
        open &= stays;
        ears &= stays;
    }
    if (is_inner && left != 3u) {
        note_broken(words, v);
        return true;
    }

    // Cut: the triangle before spoke c becomes an ear.
    make_ring(degree);
    inside = 0u;
    for (uint k = 0u; k < degree; k++) {
        places[k] = next_edge(spokes[k]);
    }
    for (uint k = 0u; k < cut_count; k++) {
        uint c = bits(cuts, k);
        uint h = spokes[c];
        uint g = prev_edge(spokes[bits(preceding, c)]);
        set_apex(triangles, prev_edge(g), ends[bits(end_of, bits(following, c))]);
        set_apex(triangles, prev_edge(h), ends[bits(end_of, bits(preceding, c))]);
        place_edge(c, g);
        across[c] = next_edge(g);
        inside |= 1u << c;
        link(links, next_edge(h), next_edge(g));
        drop_before(c);
        link(links, h, prev_edge(spokes[bits(preceding, c)]));
    }

    uint c = is_inner ? findLSB(stays) : bits(preceding, ghost);
    uint h = spokes[c];
    uint next = bits(following, c);
    uint previous = bits(preceding, c);
    if (is_inner) {
        set_apex(triangles, next_edge(h), ends[bits(end_of, previous)]);
        place_edge(next, prev_edge(h));
        place_edge(previous, h);
        free_two(v, spokes[next] / 3u, spokes[previous] / 3u);
    } else {
        uint first = bits(following, next);
        uint spoke = first;
        for (uint k = 0u; k < degree && spoke != c; k++) {
            set_apex(triangles, next_edge(spokes[spoke]), GHOST);
            spoke = bits(following, spoke);
        }
        place_edge(c, prev_edge(spokes[previous]));
        place_edge(next, spokes[first]);
        free_two(v, h / 3u, spokes[next] / 3u);
    }
    uint entry = reserve(words, OUT_EDGES + round, degree);
    for (uint k = 0u; k < degree; k++) {
        edges.at[entry + k] = uvec2(spokes[k] / 3u, places[k]);
        edge_of.at[spokes[k] / 3u] = entry + k;
    }
    state.at[v] = ends[0];
    return true;
}

// The star of a site, in shared memory.

const uint MOST_SHARED = 384u;

shared uvec4 wide_where[MOST_SHARED];
shared uint wide_spokes[MOST_SHARED];
shared uint wide_ends[MOST_SHARED]; // of spokes by now
shared uint wide_places[MOST_SHARED];
shared uint wide_across[MOST_SHARED];
shared uint wide_next[MOST_SHARED];
shared uint wide_previous[MOST_SHARED];
shared uint wide_flags[MOST_SHARED];
shared uint wide_degree;
shared uint wide_ghost;
shared uint wide_first;
// Of even and of odd passes.
shared uint wide_cuts[2];

const uint EAR = 1u;
const uint INSIDE = 2u;
const uint OPEN = 4u; // to be tested
const uint GONE = 8u;
const uint CUT = 16u;

bool is_wide_first(uint k, uint other) {
    return (wide_flags[other] & EAR) == 0u || priority(wide_ends[k]) < priority(wide_ends[other]);
}

// The outer edge of the triangle of spoke c goes to `to`.
void place_wide(uint c, uint to) {
    set_link(links, to, wide_across[c]);
    if ((wide_flags[c] & INSIDE) != 0u) {
        set_link(links, wide_across[c], to);
    } else {
        wide_places[c] = to;
    }
}

// The spokes of a star into shared memory, by one invocation: both ways round at a time.
void gather_star(uint start) {
    uint h = start;
    uint g = start;
    uint ccw_count = 0u;
    uint cw_count = 0u;
    bool closed = false;
    for (uint step = 0u; step < MOST_SHARED && !closed; step++) {
        uint ccw = step == 0u ? start : rotate_ccw(links, h);
        uint cw = rotate_cw(links, g);
        if (ccw == g && step != 0u) {
            closed = true;
        } else if (ccw_count + cw_count == MOST_SHARED) {
            break;
        } else {
            h = ccw;
            wide_spokes[ccw_count++] = h;
            if (cw == h) {
                closed = true;
            } else if (ccw_count + cw_count < MOST_SHARED) {
                g = cw;
                cw_count++;
                wide_places[MOST_SHARED - cw_count] = g;
            }
        }
    }
    wide_degree = closed ? ccw_count + cw_count : NONE;
    wide_first = ccw_count;
}

// By all invocations of the workgroup; or by none, if the star is larger than that.
bool cut_wide(uint v, uint start) {
    uint rank = gl_LocalInvocationIndex;
    barrier();
    if (rank == 0u) {
        gather_star(start);
        wide_ghost = NONE;
        wide_cuts[0] = 0u;
    }
    barrier();
    uint degree = wide_degree;
    if (degree == NONE) {
        return false;
    }
    for (uint k = rank; k < degree; k += WORKGROUP) {
        if (k >= wide_first) {
            wide_spokes[k] = wide_places[MOST_SHARED - degree + k];
        }
    }
    barrier();
    for (uint k = rank; k < degree; k += WORKGROUP) {
        uint h = wide_spokes[k];
        uint end = destination(triangles, h);
        wide_ends[k] = end;
        wide_where[k] = positions.at[end < DELETED ? end : v];
        wide_across[k] = link_of(links, next_edge(h));
        wide_places[k] = next_edge(h);
        wide_next[k] = k + 1u == degree ? 0u : k + 1u;
        wide_previous[k] = k == 0u ? degree - 1u : k - 1u;
        wide_flags[k] = OPEN;
        if (end == GHOST) {
            wide_ghost = k;
        }
    }
    barrier();
    uint ghost = wide_ghost;
    bool is_inner = ghost == NONE;
    uint heir = wide_ends[0];
    uvec4 at = positions.at[v];
    uint left = degree;
    for (uint step = 0u; step < degree && (!is_inner || left != 3u); step++) {
        for (uint k = rank; k < degree; k += WORKGROUP) {
            if ((wide_flags[k] & (OPEN | GONE)) == OPEN) {
                uint a = wide_previous[k];
                uint b = wide_next[k];
                bool is_ear = false;
                if (k != ghost && a != ghost && b != ghost) {
                    is_decided_ear(at, wide_where[a], wide_where[k], wide_where[b], is_ear);
                }
                wide_flags[k] = wide_flags[k] & INSIDE | (is_ear ? EAR : 0u);
            }
        }
        barrier();
        uint parity = step & 1u;
        for (uint k = rank; k < degree; k += WORKGROUP) {
            if ((wide_flags[k] & (EAR | GONE)) == EAR) {
                uint b = wide_next[k];
                bool first = is_wide_first(k, wide_previous[k]) && is_wide_first(k, b);
                if (first && (!is_inner || left != 4u || is_wide_first(k, wide_next[b]))) {
                    atomicOr(wide_flags[k], CUT);
                    atomicAdd(wide_cuts[parity], 1u);
                }
            }
        }
        if (rank == 0u) {
            wide_cuts[parity ^ 1u] = 0u;
        }
        barrier();
        uint cuts = wide_cuts[parity];
        if (cuts == 0u) {
            break;
        }
        // The triangle before spoke c becomes an ear; the spoke gets the end of the one before, which leaves the ring. No
        // spoke beside c is cut as well.
        for (uint c = rank; c < degree; c += WORKGROUP) {
            if ((wide_flags[c] & CUT) != 0u) {
                uint a = wide_previous[c];
                uint b = wide_next[c];
                uint before = wide_previous[a];
                uint h = wide_spokes[c];
                uint g = prev_edge(wide_spokes[a]);
                set_apex(triangles, prev_edge(g), wide_ends[b]);
                set_apex(triangles, prev_edge(h), wide_ends[a]);
                set_link(links, g, wide_across[c]);
                if ((wide_flags[c] & INSIDE) != 0u) {
                    set_link(links, wide_across[c], g);
                } else {
                    wide_places[c] = g;
                }
                wide_across[c] = next_edge(g);
                link(links, next_edge(h), next_edge(g));
                link(links, h, prev_edge(wide_spokes[before]));
                wide_ends[c] = wide_ends[a];
                wide_where[c] = wide_where[a];
                wide_previous[c] = before;
                wide_flags[a] = GONE | wide_flags[a] & INSIDE;
            }
        }
        barrier();
        for (uint c = rank; c < degree; c += WORKGROUP) {
            if ((wide_flags[c] & CUT) != 0u) {
                wide_next[wide_previous[c]] = c;
                wide_flags[c] = INSIDE | OPEN;
                atomicOr(wide_flags[wide_next[c]], OPEN);
            }
        }
        left -= cuts;
        barrier();
    }
    if (rank == 0u) {
        uint c = is_inner ? 0u : wide_previous[ghost];
        while (is_inner && c + 1u < degree && (wide_flags[c] & GONE) != 0u) {
            c++;
        }
        uint h = wide_spokes[c];
        uint next = wide_next[c];
        uint previous = wide_previous[c];
        if (is_inner && left != 3u) {
            note_broken(words, v);
        } else if (is_inner) {
            set_apex(triangles, next_edge(h), wide_ends[previous]);
            place_wide(next, prev_edge(h));
            place_wide(previous, h);
            free_two(v, wide_spokes[next] / 3u, wide_spokes[previous] / 3u);
        } else {
            uint first = wide_next[next];
            uint spoke = first;
            for (uint k = 0u; k < degree && spoke != c; k++) {
                set_apex(triangles, next_edge(wide_spokes[spoke]), GHOST);
                spoke = wide_next[spoke];
            }
            place_wide(c, prev_edge(wide_spokes[previous]));
            place_wide(next, wide_spokes[first]);
            free_two(v, h / 3u, wide_spokes[next] / 3u);
        }
        state.at[v] = heir;
        wide_degree = atomicAdd(words.at[OUT_EDGES + round], degree);
    }
    barrier();
    for (uint k = rank; k < degree; k += WORKGROUP) {
        uint t = wide_spokes[k] / 3u;
        edges.at[wide_degree + k] = uvec2(t, wide_places[k]);
        edge_of.at[t] = wide_degree + k;
    }
    return true;
}

// The star of a site, in the mesh.

// The outer edge, or the edge of an ear, at `from` goes to `to`, in another triangle of the same star.
void move_edge(uint from, uint to) {
    uint beyond = link_of(links, from);
    uint entry = edge_of.at[from / 3u];
    set_link(links, to, beyond);
    if (edges.at[entry].y == from) {
        edges.at[entry].y = to;
    } else {
        set_link(links, beyond, to);
    }
}

void flip_spoke(uint h, uint g) {
    uint h1 = next_edge(h);
    uint g1 = next_edge(g);
    uint before = link_of(links, g1);
    set_apex(triangles, prev_edge(h), apex(triangles, g));
    set_apex(triangles, prev_edge(g), apex(triangles, h));
    link(links, h, before);
    move_edge(h1, g);
    link(links, h1, g1);
}

void merge(uint v, uint h) {
    uint ccw = rotate_ccw(links, h);
    uint cw = rotate_cw(links, h);
    set_apex(triangles, next_edge(h), destination(triangles, cw));
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
        set_apex(triangles, next_edge(spoke), GHOST);
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
    uint first = reserve(words, OUT_EDGES + round, degree);
    uint h = start;
    for (uint i = 0u; i < degree; i++) {
        edges.at[first + i] = uvec2(h / 3u, next_edge(h));
        edge_of.at[h / 3u] = first + i;
        h = rotate_ccw(links, h);
    }
}

void cut_large(uint v, uint start) {
    uint to_ghost;
    uint left = look_around(start, to_ghost);
    list_edges(start, left);
    state.at[v] = destination(triangles, start);
    uint h = to_ghost == NONE ? start : rotate_ccw(links, to_ghost);
    uvec4 at = positions.at[v];
    uint most = 4u * left;
    for (uint step = 0u; step < most; step++) {
        if (to_ghost == NONE && left == 3u) {
            merge(v, h);
            return;
        }
        uint b = apex(triangles, h);
        if (b == GHOST) {
            to_infinity(v, h);
            return;
        }
        uint g = twin(links, h);
        uint a = apex(triangles, g);
        uint l = destination(triangles, h);
        bool is_ear = false;
        if (a != GHOST) {
            is_decided_ear(at, positions.at[a], positions.at[l], positions.at[b], is_ear);
        }
        if (is_ear) {
            flip_spoke(h, g);
            left--;
        } else {
            h = rotate_ccw(links, h);
        }
    }
    note_broken(words, v);
}

// So few stars that a workgroup for each is as fast.
layout(constant_id = 2) const uint FEW = 1024u;

void main() {
    uint count = words.at[(again != 0u ? OUT_DEFERRED : OUT_WINNERS) + round];
    if (ARITHMETIC != FAST) {
        for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
            uint start = again != 0u ? deferred.at[i] : winners.at[i];
            uint v = origin(triangles, start);
            if (!cut_wide(v, start) && gl_LocalInvocationIndex == 0u) {
                cut_large(v, start);
            }
        }
        return;
    }
    for (uint i = first_item(); i < count; i += item_stride()) {
        uint start = winners.at[i];
        if (count <= FEW) {
            deferred.at[append(words, OUT_DEFERRED + round)] = start;
            continue;
        }
        uint v = origin(triangles, start);
        uint degree = 0u;
        uint ghost = NONE;
        uint h = start;
        bool closed = false;
        for (uint first = 0u; first < MOST && !closed; first += STEPS) {
            uint spoke[STEPS];
            uint end[STEPS];
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                spoke[k] = h;
                end[k] = destination(triangles, h);
                if (!closed) {
                    degree++;
                    h = rotate_ccw(links, h);
                    closed = h == start;
                }
            }
            [[unroll]] for (uint k = 0u; k < STEPS; k++) {
                spokes[first + k] = spoke[k];
                ends[first + k] = end[k];
                ghost = end[k] == GHOST && first + k < degree ? first + k : ghost;
            }
        }
        if (!closed || !cut_small(v, degree, ghost)) {
            deferred.at[append(words, OUT_DEFERRED + round)] = start;
        }
    }
}
