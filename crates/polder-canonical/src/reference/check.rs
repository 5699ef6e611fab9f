//! The certificate: that finite triangles cover the convex hull of the vertices without overlap.
//!
//! What is checked, each of it by looking at one triangle and the ones next to it:
//!
//! 1. Links lead back, join the same two vertices, and have the same mark of a constrained edge.
//! 2. Every finite triangle is strictly counterclockwise.
//! 3. The hull turns right nowhere, and folds back nowhere but at the two ends of a chain.
//! 4. It has one lexicographically lowest corner.
//! 5. There are two triangles less than twice as many as vertices, ghosts included.
//!
//! Proof. Links that lead back cancel each other as edges, so that what bounds the finite triangles, taken together, are
//! the hull edges, and those make rings. As triangles are counterclockwise, the number of them over a point in general
//! position is the number of times that the rings wind round it. A ring that never turns right winds round as often as it
//! has lowest corners, and each has one at least: so by 4 there is one ring, a convex polygon, and over each point inside
//! lies one triangle, over each point outside none. Two triangles linked by an edge lie on both sides of all of it, so no
//! corner lies inside an edge. That makes a triangulation of the corners in it, and one of `n` corners has `2 n - 2`
//! triangles with the ghosts: so by 5 every vertex is among them. Vertices on one line have no finite triangle, and the
//! ring is a chain, there and back.

use crate::CanonicalError;
use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh, NONE, prev};
use polder_predicates::{Sign, orient2d};

/// What one look at every triangle finds: the lowest slots at fault, [`NONE`] for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Check {
    /// A link that does not lead back, joins different vertices, or has another mark on its other side.
    pub broken: u32,
    /// A finite triangle that is not strictly counterclockwise.
    pub clockwise: u32,
    /// The ghost triangle of a hull edge at whose end the hull turns right or folds back.
    pub reflex: u32,
    /// Lexicographically lowest corners of the hull.
    pub minima: u32,
}

/// Looks at every triangle. `finite` says whether there is a finite one.
pub fn check_triangles(mesh: &GhostMesh, positions: &[DVec2], finite: bool) -> Check {
    let mut check = Check { broken: NONE, clockwise: NONE, reflex: NONE, minima: 0 };
    let at = |v: u32| positions[v as usize];
    for t in (0..mesh.slots()).filter(|&t| !mesh.is_deleted(t)) {
        let slot = t as u32;
        if !(0..3).all(|k| leads_back(mesh, 3 * slot + k)) {
            check.broken = check.broken.min(slot);
            continue;
        }
        let corners = mesh.triangles[t];
        let Some(k) = corners.iter().position(|&v| v == GHOST) else {
            let [a, b, c] = corners.map(at);
            if orient2d(a, b, c) != Sign::Positive {
                check.clockwise = check.clockwise.min(slot);
            }
            continue;
        };
        // The hull runs from u to v along h, and on to w.
        let h = 3 * slot + k as u32;
        let following = prev(mesh.twin(prev(h)));
        let (u, v, w) = (mesh.destination(h), mesh.origin(h), mesh.origin(following));
        if [u, v, w].iter().any(|&v| v as usize >= positions.len()) {
            check.broken = check.broken.min(slot);
            continue;
        }
        let (p, q, r) = (at(u), at(v), at(w));
        check.minima += u32::from(before(q, p) && before(q, r));
        let turn = if u == w { Sign::Zero } else { orient2d(p, q, r) };
        let folds = turn == Sign::Zero && before(p, q) != before(q, r);
        if turn == Sign::Negative || folds && (finite || u != w) {
            check.reflex = check.reflex.min(slot);
        }
    }
    check
}

fn leads_back(mesh: &GhostMesh, h: u32) -> bool {
    let g = mesh.twin(h);
    g as usize / 3 < mesh.slots()
        && mesh.twin(g) == h
        && mesh.is_constrained(g) == mesh.is_constrained(h)
        && mesh.origin(h) == mesh.destination(g)
        && mesh.destination(h) == mesh.origin(g)
}

/// Lexicographically before, by value: -0.0 equals 0.0.
fn before(p: DVec2, q: DVec2) -> bool {
    p.x < q.x || p.x == q.x && p.y < q.y
}

/// Checks the whole certificate of a mesh of so many vertices.
///
/// # Errors
///
/// What does not hold, with the slot at fault.
pub fn certify(mesh: &GhostMesh, positions: &[DVec2], vertices: u32) -> Result<(), CanonicalError> {
    let finite = mesh.finite().count() as u32;
    let ghosts = (0..mesh.slots()).filter(|&t| !mesh.is_deleted(t)).count() as u32 - finite;
    check_triangles(mesh, positions, finite > 0).verdict(finite, ghosts, vertices)
}

impl Check {
    /// What it says of a mesh of so many triangles and vertices.
    ///
    /// # Errors
    ///
    /// What does not hold, with the slot at fault.
    pub fn verdict(self, finite: u32, ghosts: u32, vertices: u32) -> Result<(), CanonicalError> {
        if self.broken != NONE {
            return Err(CanonicalError::Broken { triangle: self.broken });
        }
        if self.clockwise != NONE {
            return Err(CanonicalError::NotCounterclockwise { triangle: self.clockwise });
        }
        if self.reflex != NONE {
            return Err(CanonicalError::HullNotConvex { triangle: self.reflex });
        }
        let triangles = u64::from(finite) + u64::from(ghosts);
        let wanted = 2 * u64::from(vertices.max(1)) - 2;
        if triangles != wanted {
            return Err(CanonicalError::Count { triangles, vertices });
        }
        match self.minima {
            1 => Ok(()),
            0 if vertices < 2 => Ok(()),
            times => Err(CanonicalError::HullWinds { times }),
        }
    }
}
