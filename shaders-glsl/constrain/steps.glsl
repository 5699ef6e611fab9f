// Steps of straight walks along constraints: out of the star of a vertex, and from triangle to triangle.
//
// All signs are those of the line from one end of the constraint to the other, also where the walk leaves a vertex between
// them, which lies on the line exactly: what differs from step to step is the vertex that is held against the line, so
// that there is one predicate in a walk, in `advance`. Call it from one place, in a loop:
//
//     Walker walker = turn_from(spoke, point_at(positions, from), point_at(positions, to));
//     for (uint step = 0u; step < most; step++) {
//         uint event = advance(walker, triangles, links, positions);
//         if (event == LEAVES) { ... the triangle of walker.h, by its half-edge walker.h ... }
//         ...
//     }
//
// Most constraints that are short are edges: `edge_to` finds them by the numbers of vertices alone.
#ifndef STEPS_GLSL
#define STEPS_GLSL

#include "edge_to.glsl"
#include "mesh.glsl"
#include "predicates.glsl"

// What a step has led to.
// Nothing yet: the walk turns about a vertex.
const uint TURNS = 0u;
// The line runs through the interior of the triangle of `h` and leaves it across h, whose origin lies right of the line and
// whose destination lies left of it.
const uint LEAVES = 1u;
// The line runs along the half-edge `h`, whose destination is the next vertex on it.
const uint ALONG = 2u;
// The line has entered the triangle of `h` across h, and its apex lies on the line: that is the next vertex.
const uint AT_APEX = 3u;
// The mesh is no triangulation of a convex hull. The walk is over.
const uint LOST = 4u;

// What the next step looks at: the other end of the first spoke, the spoke after `h`, or what lies beyond h.
const uint AT_SPOKE = 0u;
const uint TURNING = 1u;
const uint CROSSING = 2u;

struct Walker {
    Point a; // the line
    Point b;
    uint h;
    uint start; // the first spoke of a turn
    uint state;
    int right;  // the side on which the other end of the spoke h lies, or NO_SIDE
};

// Where the vertex at infinity lies.
const int NO_SIDE = 2;

// A walk that leaves the origin of this half-edge in the direction from a to b.
Walker turn_from(uint spoke, Point a, Point b) {
    return Walker(a, b, spoke, spoke, AT_SPOKE, NO_SIDE);
}

// The same walk goes on from the vertex that this event has led to.
void turn_again(inout Walker walker, uint event, ReadRows links) {
    // First backward along the edge, or to the corner on the right: the way on is among the next spokes.
    walker.h = twin(links, event == ALONG ? walker.h : next_edge(walker.h));
    walker.start = walker.h;
    walker.state = TURNING;
    walker.right = event == ALONG ? 0 : -1;
}

// A walk that is about to leave the triangle of h across h.
Walker cross_from(uint h, Point a, Point b) {
    return Walker(a, b, h, h, CROSSING, NO_SIDE);
}

// Of a vertex w on the line from a to b, whether it comes after v in that direction.
bool lies_ahead(Point v, Point w, Point a, Point b) {
    bool upright = order_of(a.xy) == order_of(b.xy);
    int64_t from = order_of(upright ? v.zw : v.xy);
    int64_t to = order_of(upright ? w.zw : w.xy);
    bool up = upright ? order_of(a.zw) < order_of(b.zw) : order_of(a.xy) < order_of(b.xy);
    return from != to && (from < to) == up;
}

// One step, with one sign.
uint advance(inout Walker walker, ReadRows triangles, ReadRows links, ReadPoints positions) {
    uint h = walker.h;
    if (walker.state == CROSSING) {
        h = twin(links, h);
    }
    if (h >= HALF_EDGE) {
        return LOST;
    }
    uint w = walker.state == AT_SPOKE ? destination(triangles, h) : apex(triangles, h);
    int side = NO_SIDE;
    Point p = walker.a;
    if (w < DELETED) {
        p = point_at(positions, w);
        side = orient2d(walker.a, walker.b, p);
    }
    if (walker.state == CROSSING) {
        walker.h = h;
        if (side == NO_SIDE) {
            return LOST;
        }
        if (side == 0) {
            return AT_APEX;
        }
        walker.h = side > 0 ? next_edge(h) : prev_edge(h);
        return LEAVES;
    }
    if (walker.state == TURNING) {
        if (walker.right == -1 && side == 1) {
            walker.h = next_edge(h);
            walker.state = CROSSING;
            return LEAVES;
        }
        h = rotate_ccw(links, h);
        if (h == walker.start || h == HALF_EDGE) {
            return LOST;
        }
        walker.h = h;
    }
    walker.state = TURNING;
    walker.right = side;
    if (side == 0 && lies_ahead(point_at(positions, origin(triangles, h)), p, walker.a, walker.b)) {
        return ALONG;
    }
    return TURNS;
}

#endif
