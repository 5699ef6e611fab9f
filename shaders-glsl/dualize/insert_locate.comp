// Insertion, 1 of 4 of a round: finds the container of each point by a straight walk, and its score, which claims the
// container in the first of two steps. A point on a vertex is a duplicate, and done.
//
// The walk is `reference::locate` and `reference::sector`, as one loop with one predicate in it. STATE says which line the
// point is held against next:
//
// - TURN, CLOCKWISE, COUNTERCLOCKWISE: the edge from the start to the next vertex around it;
// - EXIT: the edge by which the segment leaves a triangle;
// - CORNER: the segment's start and the corner behind that edge;
// - RIGHT, LEFT: outside the hull, the ray from the center through the right or left end of a hull edge;
// - BEYOND_HULL: where the walk starts from a ghost triangle, its hull edge.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "insert.glsl"
#include "insert_key.glsl"

layout(push_constant, std430) uniform Args {
    Rows triangles;
    Rows links;
    ReadPoints positions;
    ReadU32x2 waiting;
    ReadU32x2 freed;
    WriteU32 places;
    U32 claims;    // all NONE before
    WriteU32 vertex_of;
    U32 words;
    uint limit;
    uint vertices;
};

const uint TURN = 0u;
const uint CLOCKWISE = 1u;
const uint COUNTERCLOCKWISE = 2u;
const uint EXIT = 3u;
const uint CORNER = 4u;
const uint RIGHT = 5u;
const uint LEFT = 6u;
const uint BEYOND_HULL = 7u;

// What a step may lead to instead of a line.
const uint BEGIN = 8u;
const uint ALONG = 9u;
const uint OUTSIDE = 10u;

// How a walk ends.
const uint IN_TRIANGLE = 0u;
const uint AT_EDGE = 1u;
const uint AT_VERTEX = 2u;
const uint NOWHERE = 3u;

const int BEHIND = -1;
const int BETWEEN = 0;
const int AT_END = 1;
const int BEYOND = 2;

// Where p lies on the line from v to w, which differ.
int order_on_ray(Point v, Point p, Point w) {
    bool upright = order_of(v.xy) == order_of(w.xy);
    int64_t from = order_of(upright ? v.zw : v.xy);
    int64_t at = order_of(upright ? p.zw : p.xy);
    int64_t to = order_of(upright ? w.zw : w.xy);
    bool up = from < to;
    if (at == from || (at < from) == up) {
        return BEHIND;
    }
    if (at == to) {
        return AT_END;
    }
    return (at < to) == up ? BETWEEN : BEYOND;
}

// Where the walk to p from the triangle of half-edge h ends: a triangle, a half-edge or a vertex.
uint walk(Point p, uint h, out uint place) {
    // Both kinds of search end much sooner in a triangulation.
    uint steps = 24u * min(vertices, 150000000u) + 16u;
    uint state = BEGIN;
    uint v = 0u;              // the start
    Point start = p;
    uint g = 0u;              // a half-edge, as STATE has it
    Point a = p;
    Point b = p;
    uint ray = 0u;            // of the center
    int right = 0;
    int left = 0;
    bool clockwise = false;
    bool first = true;
    uvec3 corner = corners(triangles, h / 3u);
    if (any(equal(corner, uvec3(GHOST)))) {
        // Who was outside before mostly still is, and turning around a vertex of the hull can take long.
        g = h - h % 3u + (corner.x == GHOST ? 0u : corner.y == GHOST ? 1u : 2u);
        state = BEYOND_HULL;
        a = point_at(positions, origin(triangles, g));
        b = point_at(positions, destination(triangles, g));
    }
    while (steps > 0u) {
        steps--;
        if (state == BEGIN) {
            v = origin(triangles, h);
            if (v == GHOST) {
                break;
            }
            start = point_at(positions, v);
            if (same_point(p, start)) {
                place = v;
                return AT_VERTEX;
            }
            // To a half-edge whose triangle is finite: at a hull vertex two steps on at most.
            for (uint k = 0u; k < 2u; k++) {
                if (is_ghost(triangles, h / 3u)) {
                    h = rotate_ccw(links, h);
                }
            }
            state = TURN;
            a = start;
            b = point_at(positions, destination(triangles, h));
        }
        int sign = orient2d(a, b, p);

        if (state == TURN || state == CLOCKWISE || state == COUNTERCLOCKWISE) {
            // For COUNTERCLOCKWISE the edge is that of g, the one after h.
            bool onward = state != COUNTERCLOCKWISE;
            uint tested = onward ? h : g;
            if (sign == 0 && (state != TURN || order_on_ray(start, p, b) != BEHIND)) {
                g = tested;
                state = ALONG;
            } else if (state == CLOCKWISE && sign > 0) {
                state = EXIT;
            } else if (state == COUNTERCLOCKWISE && sign < 0) {
                state = EXIT;
            } else if (sign < 0) {
                uint other = twin(links, h);
                if (apex(triangles, other) == GHOST) {
                    g = other;
                    state = OUTSIDE;
                } else {
                    h = next_edge(other);
                    state = CLOCKWISE;
                    b = point_at(positions, destination(triangles, h));
                }
            } else {
                h = tested;
                if (apex(triangles, h) == GHOST) {
                    g = h;
                    state = OUTSIDE;
                } else {
                    g = rotate_ccw(links, h);
                    state = COUNTERCLOCKWISE;
                    b = point_at(positions, destination(triangles, g));
                }
            }
            if (state == EXIT) {
                g = next_edge(h);
                b = point_at(positions, destination(triangles, g));
                a = point_at(positions, origin(triangles, g));
            }
        } else if (state == EXIT) {
            if (sign >= 0) {
                place = sign > 0 ? g / 3u : g;
                return sign > 0 ? IN_TRIANGLE : AT_EDGE;
            }
            g = twin(links, g);
            uint c = apex(triangles, g);
            if (c == GHOST) {
                state = OUTSIDE;
            } else {
                state = CORNER;
                a = start;
                b = point_at(positions, c);
            }
        } else if (state == BEYOND_HULL) {
            state = sign > 0 ? OUTSIDE : BEGIN;
            if (origin(triangles, h) == GHOST) {
                h = next_edge(h);
            }
            if (state == BEGIN) {
                continue;
            }
        } else if (state == CORNER) {
            if (sign == 0) {
                int order = order_on_ray(start, p, b);
                if (order == AT_END) {
                    place = apex(triangles, g);
                    return AT_VERTEX;
                }
                if (order == BETWEEN) {
                    place = g / 3u;
                    return IN_TRIANGLE;
                }
                h = prev_edge(g);
                state = BEGIN;
            } else {
                // The corner is right of the segment: out between it and the left end.
                g = sign > 0 ? prev_edge(g) : next_edge(g);
                state = EXIT;
                a = point_at(positions, origin(triangles, g));
                b = point_at(positions, destination(triangles, g));
            }
        } else {
            // Where one corner of the center does not tell, the next one does.
            if (sign == 0 && ray < 2u) {
                ray++;
                a = point_at(positions, words.at[CENTER + ray]);
                continue;
            }
            if (state == RIGHT) {
                right = sign;
            } else {
                left = sign;
            }
            if (first && state == RIGHT) {
                clockwise = right < 0;
                state = LEFT;
            } else if (right > 0 && left < 0) {
                place = h / 3u;
                return IN_TRIANGLE;
            } else if (clockwise) {
                h = next_edge(twin(links, next_edge(h)));
                left = right;
                state = RIGHT;
            } else {
                h = prev_edge(twin(links, prev_edge(h)));
                right = left;
                state = LEFT;
            }
            first = first && state == RIGHT;
            ray = 0u;
            a = point_at(positions, words.at[CENTER]);
            b = point_at(positions, state == RIGHT ? destination(triangles, h) : origin(triangles, h));
        }

        if (state == ALONG) {
            uint w = destination(triangles, g);
            int order = order_on_ray(start, p, point_at(positions, w));
            if (order == AT_END || order == BETWEEN) {
                place = order == AT_END ? w : g;
                return order == AT_END ? AT_VERTEX : AT_EDGE;
            }
            h = twin(links, g);
            state = BEGIN;
        } else if (state == OUTSIDE) {
            // The hull edge as its ghost triangle sees it: opposite the ghost.
            h = g - g % 3u;
            while (h % 3u < 2u && apex(triangles, h) != GHOST) {
                h++;
            }
            state = RIGHT;
            ray = 0u;
            a = point_at(positions, words.at[CENTER]);
            b = point_at(positions, destination(triangles, h));
        }
    }
    place = NONE;
    return NOWHERE;
}

// The first step of a claim.
void claim(uint t, uint score) {
    // What has been read may be old, but never less than what is there.
    if (claims.at[CLAIM * t + SCORE] > score) {
        atomicMin(claims.at[CLAIM * t + SCORE], score);
    }
}

void main() {
    uint i = item_index();
    if (i >= words.at[WAITING]) {
        return;
    }
    uvec2 entry = waiting.at[words.at[PARITY] * limit + i];
    Point p = point_at(positions, entry.x);
    uint place;
    uint found = walk(p, entry.y, place);
    uint score = INSIDE;
    uint stored = NONE;
    if (found == AT_EDGE) {
        // One name for each edge, whichever way the walk came.
        uint other = twin(links, place);
        uint h = min(place, other);
        stored = h | ON_EDGE;
        score = score_on_edge(p, point_at(positions, origin(triangles, h)), point_at(positions, destination(triangles, h)));
        claim(place / 3u, score);
        claim(other / 3u, score);
    } else if (found == IN_TRIANGLE) {
        stored = 3u * place;
        uvec3 corner = corners(triangles, place);
        if (any(equal(corner, uvec3(GHOST)))) {
            // The hull edge from u to w, in the ghost triangle of w, u and the ghost.
            uint k = corner.x == GHOST ? 0u : corner.y == GHOST ? 1u : 2u;
            Point w = point_at(positions, corner[(k + 1u) % 3u]);
            Point u = point_at(positions, corner[(k + 2u) % 3u]);
            score = score_outside(p, u, w);
        }
        claim(place, score);
    } else if (found == AT_VERTEX) {
        vertex_of.at[entry.x] = place;
        if (place != entry.x) {
            atomicAdd(words.at[DUPLICATES], 1u);
            uvec2 own = slots_of(entry.x, freed, ReadU32(words));
            free_slot(triangles, links, own.x);
            free_slot(triangles, links, own.y);
        }
    } else {
        atomicMin(words.at[LOST], entry.x);
    }
    places.at[2u * i] = stored;
    places.at[2u * i + 1u] = score;
}
