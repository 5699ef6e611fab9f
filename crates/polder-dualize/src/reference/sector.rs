//! The containers outside the hull.
//!
//! Two points outside may see the same hull edge, and triangles from two hull edges to two points may overlap although
//! they share nothing: the hull then winds round twice, which orientation, links, the empty circle property of each
//! edge and the count of triangles all fail to notice. So the outside is divided once and for all: seen from one fixed
//! point strictly inside the hull, each hull edge covers a sector, and a point outside belongs to the ghost triangle
//! of its sector's edge. Sectors do not overlap, so neither do triangles in different sectors, and the hull stays
//! star-shaped around the fixed point until ghost flips have made it convex again. It never shrinks, so the point
//! stays inside.
//!
//! The fixed point is not rounded from anything: near one line there may be no f64 strictly inside. It lies infinitely
//! near a vertex `a` of a finite triangle `a, b, c`, at `a + ε (b - a) + ε² (c - a)` for an infinitely small `ε > 0`.
//! Since orient2d is affine in its first argument, the side on which this point sees `p` past `u` has the sign of
//! orient2d(a, u, p), or where that is zero orient2d(b, u, p), or where that is zero as well orient2d(c, u, p). Not all
//! three are zero while `u` and `p` differ. So no point lies between two sectors, and each sector includes neither of
//! its two sides.

use super::certify::{next_hull_edge, previous_hull_edge};
use super::star::broken;
use crate::DualizeError;
use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh};
use polder_predicates::{Sign, orient2d};

/// The point strictly inside from which sectors are seen, as the triangle that it is infinitely near a corner of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Center(pub(super) [DVec2; 3]);

impl Center {
    /// In the first finite triangle, if there is one.
    pub(super) fn of(mesh: &GhostMesh, positions: &[DVec2]) -> Option<Self> {
        mesh.finite().next().map(|t| Self(mesh.triangles[t].map(|v| positions[v as usize])))
    }

    /// Positive if `p` lies left of the ray from the center through `u`.
    fn side(&self, u: DVec2, p: DVec2) -> Sign {
        self.0.iter().map(|&o| orient2d(o, u, p)).find(|&sign| sign != Sign::Zero).unwrap_or(Sign::Zero)
    }
}

/// The ghost triangle in whose sector `p` lies, which is strictly outside; the search starts from another ghost
/// triangle and goes along the hull. Counts its steps.
pub(super) fn sector(
    mesh: &GhostMesh,
    positions: &[DVec2],
    center: &Center,
    p: DVec2,
    ghost: u32,
    steps: &mut u64,
) -> Result<u32, DualizeError> {
    let Some(k) = mesh.triangles[ghost as usize].iter().position(|&v| v == GHOST) else {
        return Err(broken("insert", GHOST));
    };
    let side = |v: u32| center.side(positions[v as usize], p);
    // The hull edge from u to w as the ghost triangle sees it: from w to u.
    let mut h = 3 * ghost + k as u32;
    let (mut right, mut left) = (side(mesh.destination(h)), side(mesh.origin(h)));
    let clockwise = right == Sign::Negative;
    for _ in 0..mesh.slots() {
        *steps += 1;
        if right == Sign::Positive && left == Sign::Negative {
            return Ok(h / 3);
        }
        if clockwise {
            h = previous_hull_edge(mesh, h);
            (right, left) = (side(mesh.destination(h)), right);
        } else {
            h = next_hull_edge(mesh, h);
            (right, left) = (left, side(mesh.origin(h)));
        }
    }
    Err(broken("insert", mesh.origin(h)))
}
