//! The certificate with which each stage ends.
//!
//! For a mesh that is a sphere: if every finite triangle is strictly counterclockwise, and the hull turns right nowhere
//! and winds round once, then the finite triangles cover the convex hull of the vertices without overlap.
//!
//! Proof. Let there be `v` vertices, `h` hull edges and `f` finite triangles; on a sphere with a ghost, `f = 2v - h - 2`.
//! The angles of all triangles sum to `f π`. Around a vertex inside, the triangles close up and are counterclockwise,
//! so their angles sum to a positive multiple of 2π; let `e` be the excess over 2π of all these vertices together. Let
//! the hull meet `d` different vertices. Then the angles left for the hull sum to `f π - 2π (v - d) - e`, and its turns,
//! π less the angle each time it meets a vertex, to `2π + e + 2π (h - d)`. A turn computed from three positions differs
//! from this by 2π where the angle exceeds 2π, always upwards if it is not a right turn. So if the hull winds once,
//! then `e = 0`, it meets no vertex twice, and no angle exceeds 2π: the triangles around each vertex cover its
//! neighborhood once, the disk is mapped without folds, its border is a convex polygon, and such a map is one-to-one.
//!
//! How often a polygon that never turns right winds round is the number of its lexicographically lowest corners, which
//! takes comparisons of coordinates alone. A chain passes too: its hull runs to the far end and back.

use super::star::broken;
use crate::DualizeError;
use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh, next, prev};
use polder_predicates::{Sign, orient2d};

/// Checks the certificate of a mesh; `stage` is named in the error.
///
/// The positions of all vertices are needed. What is checked: every finite triangle is strictly counterclockwise; the
/// ghost triangles form one ring; the hull is nowhere reflex, folds back nowhere but at the two ends of a chain, and
/// has one lexicographically lowest corner.
///
/// # Errors
///
/// [`DualizeError::NotCounterclockwise`], [`DualizeError::HullNotConvex`], [`DualizeError::HullWinds`],
/// [`DualizeError::Broken`].
pub fn certify(mesh: &GhostMesh, positions: &[DVec2], stage: &'static str) -> Result<(), DualizeError> {
    let at = |v: u32| positions[v as usize];
    let (mut finite, mut ghosts, mut start) = (0, 0, None);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        if mesh.is_deleted(t) {
            continue;
        }
        if let Some(k) = corners.iter().position(|&v| v == GHOST) {
            ghosts += 1;
            start.get_or_insert(3 * t as u32 + k as u32);
            continue;
        }
        finite += 1;
        let [a, b, c] = corners.map(at);
        if orient2d(a, b, c) != Sign::Positive {
            return Err(DualizeError::NotCounterclockwise { stage, triangle: t });
        }
    }
    let Some(start) = start else {
        return if finite == 0 { Ok(()) } else { Err(broken(stage, GHOST)) };
    };

    // h is the hull edge as its ghost triangle sees it: from w to v, where the hull runs from v to w.
    let mut h = start;
    let mut minima = 0;
    for step in 1..=ghosts {
        let following = next_hull_edge(mesh, h);
        let (u, v, w) = (mesh.destination(h), mesh.origin(h), mesh.origin(following));
        if mesh.apex(following) != GHOST || mesh.destination(following) != v {
            return Err(broken(stage, v));
        }
        let (p, q, r) = (at(u), at(v), at(w));
        if before(q, p) && before(q, r) {
            minima += 1;
        }
        let turn = if u == w { Sign::Zero } else { orient2d(p, q, r) };
        let folds = turn == Sign::Zero && before(p, q) != before(q, r);
        if turn == Sign::Negative || folds && (finite > 0 || u != w) {
            return Err(DualizeError::HullNotConvex { stage, vertex: v });
        }
        h = following;
        if (h == start) != (step == ghosts) {
            return Err(broken(stage, v));
        }
    }
    if minima == 1 { Ok(()) } else { Err(DualizeError::HullWinds { stage, times: minima }) }
}

/// From the hull edge of a ghost triangle, as the half-edge opposite the ghost, the next one counterclockwise.
pub(super) fn next_hull_edge(mesh: &GhostMesh, h: u32) -> u32 {
    // The ghost triangle of the hull edge from v to w has corners w, v, ghost; the edge from the ghost to w leads on.
    prev(mesh.twin(prev(h)))
}

/// From the hull edge of a ghost triangle, as the half-edge opposite the ghost, the next one clockwise.
pub(super) fn previous_hull_edge(mesh: &GhostMesh, h: u32) -> u32 {
    next(mesh.twin(next(h)))
}

/// Lexicographically before, by value: -0.0 equals 0.0.
pub(super) fn before(p: DVec2, q: DVec2) -> bool {
    p.x < q.x || p.x == q.x && p.y < q.y
}
