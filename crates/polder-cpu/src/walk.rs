//! The straight walk from a vertex along a constraint.

use crate::mesh::{NONE, Slab, k, next, prev};
use glam::DVec2;
use polder_mesh::GHOST;
use polder_predicates::{Sign, orient2d};

/// What a walk meets first on its way from a vertex.
pub(crate) enum First {
    /// An edge of the mesh that leads along the constraint.
    Edge(u32),
    /// An edge that the constraint crosses, as seen from the triangle at the start: from its right to its left end.
    Crossed(u32),
    /// Nothing: the mesh around the vertex is broken.
    Nothing,
}

/// Whether `p`, known to be on the line through `a` and `b`, lies on `b`'s side of `a`.
fn ahead(a: DVec2, b: DVec2, p: DVec2) -> bool {
    if a.x == b.x { (p.y > a.y) == (b.y > a.y) } else { (p.x > a.x) == (b.x > a.x) }
}

/// Looks around vertex `a` for the way to vertex `b`; `start` is any half-edge out of `a`.
pub(crate) fn first(points: &[DVec2], slab: &Slab<'_>, start: u32, a: u32, b: u32) -> First {
    // Most constraints of real input are edges already: look by id before asking a predicate.
    let mut h = start;
    loop {
        if slab.destination(h) == b {
            return First::Edge(h);
        }
        h = slab.twin(prev(h));
        if h == start {
            break;
        }
    }
    let (pa, pb) = (points[a as usize], points[b as usize]);
    let side = |v: u32| (v != GHOST).then(|| orient2d(pa, pb, points[v as usize]));
    let mut right = side(slab.destination(h));
    loop {
        let v = slab.destination(h);
        if right == Some(Sign::Zero) && ahead(pa, pb, points[v as usize]) {
            return First::Edge(h);
        }
        let around = slab.twin(prev(h));
        let left = side(slab.destination(around));
        // The triangle (a, right, left) spans less than a half turn, so that b is ahead of it where the signs differ
        // this way round.
        if right == Some(Sign::Negative) && left == Some(Sign::Positive) {
            return First::Crossed(next(h));
        }
        (h, right) = (around, left);
        if h == start {
            return First::Nothing;
        }
    }
}

/// Where a walk through triangles ends.
pub(crate) enum End {
    /// At a vertex on the constraint: its far end or one on the way.
    Vertex(u32),
    /// At a constrained edge that it crosses.
    Constrained,
    /// Past its bound.
    Lost,
}

/// The triangles that a piece of a constraint crosses, and the two chains of vertices on its sides.
#[derive(Default)]
pub(crate) struct Strip {
    /// The triangles, from the first to the last.
    pub(crate) tris: Vec<u32>,
    /// The half-edges of these triangles on the left border, from the start to the end.
    pub(crate) left: Vec<u32>,
    /// The same on the right.
    pub(crate) right: Vec<u32>,
}

/// Walks from vertex `a` towards `b` through the edge `crossed` until a vertex lies on the way.
pub(crate) fn along(points: &[DVec2], slab: &Slab<'_>, strip: &mut Strip, crossed: u32, a: u32, b: u32) -> End {
    let (pa, pb) = (points[a as usize], points[b as usize]);
    strip.tris.clear();
    strip.left.clear();
    strip.right.clear();
    strip.tris.push(crossed >> 2);
    strip.left.push(next(crossed));
    strip.right.push(prev(crossed));
    let mut h = crossed;
    while strip.tris.len() <= slab.tris.len() {
        if slab.is_constrained(h) {
            return End::Constrained;
        }
        let g = slab.twin(h);
        if g == NONE {
            return End::Lost;
        }
        let w = slab.apex(g);
        if w == GHOST {
            return End::Lost;
        }
        strip.tris.push(g >> 2);
        // Seen from the new triangle g runs from left to right; its next edge leads from the right end to w.
        let side = if w == b { Sign::Zero } else { orient2d(pa, pb, points[w as usize]) };
        match side {
            Sign::Zero => {
                strip.right.push(next(g));
                strip.left.push(prev(g));
                return End::Vertex(w);
            }
            Sign::Positive => {
                strip.left.push(prev(g));
                h = next(g);
            }
            Sign::Negative => {
                strip.right.push(next(g));
                h = prev(g);
            }
        }
        debug_assert!(k(h) < 3);
    }
    End::Lost
}
