//! The kinds of pairs of triangles along a constraint. \[QCT\] section 4.2, figure 4.

use super::fan::{Departure, depart_by_turning, enter, leave};
use crate::ConstrainError;
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE};
use polder_predicates::{Sign, orient2d};

/// A pair of adjacent triangles, both crossed by a constraint, by what a flip of their common edge would leave.
///
/// A quadrilateral with a corner of exactly half a turn counts as concave: its flip would leave a triangle without
/// area.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Configuration {
    /// No intersection: the flip makes the constraint an edge.
    Zero,
    /// One triangle that the constraint crosses.
    Single,
    /// Two, as before.
    Double,
    /// No flip is possible: the quadrilateral is not strictly convex.
    Concave,
}

impl Configuration {
    /// The digit that \[QCT\] gives it in the number of a chain: 0, 1 or 2.
    pub fn digit(self) -> u8 {
        match self {
            Self::Zero | Self::Single => 0,
            Self::Double => 1,
            Self::Concave => 2,
        }
    }
}

/// On which side of its constraint a corner lies: 1 left, -1 right, 0 at one of its ends.
pub(super) type Side = i8;

/// The configuration of the triangles `(near, right, left)` and `(far, left, right)`, seen along a constraint that
/// leaves the first one across the edge from `right` to `left`.
pub(super) fn configuration(
    positions: &[DVec2],
    [near, far]: [(u32, Side); 2],
    [right, left]: [u32; 2],
) -> Configuration {
    let at = |v: u32| positions[v as usize];
    let convex = orient2d(at(near.0), at(right), at(far.0)) == Sign::Positive
        && orient2d(at(far.0), at(left), at(near.0)) == Sign::Positive;
    match (convex, near.1, far.1) {
        (false, ..) => Configuration::Concave,
        (true, 0, 0) => Configuration::Zero,
        (true, near, far) if near * far < 0 => Configuration::Double,
        _ => Configuration::Single,
    }
}

/// The chain of triangles that a constraint crosses, and the configurations of its pairs.
///
/// Its text form is one line: a digit a pair (0 zero or single, 1 double, 2 concave).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TriangleChain {
    /// The triangles in order; none if the constraint is an edge.
    pub triangles: Vec<u32>,
    /// One for each two successive triangles.
    pub configurations: Vec<Configuration>,
}

impl TriangleChain {
    /// What falls with every flip (\[QCT\] Claim 1), in lexicographic order: the length, and the number in base 3, its
    /// first digit first. The number alone can rise at a flip of case 1.
    pub fn measure(&self) -> (usize, Vec<u8>) {
        (self.triangles.len(), self.configurations.iter().map(|c| c.digit()).collect())
    }
}

impl std::fmt::Display for TriangleChain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.configurations.iter().try_for_each(|c| write!(f, "{}", c.digit()))
    }
}

/// The chain of a sub-constraint from its first vertex to its second.
///
/// # Errors
///
/// [`ConstrainError::ThroughVertex`], [`ConstrainError::Lost`], [`ConstrainError::NotAVertex`].
pub fn triangle_chain(mesh: &GhostMesh, positions: &[DVec2], ends: [u32; 2]) -> Result<TriangleChain, ConstrainError> {
    let spokes = mesh.half_edge_of_vertex(positions.len());
    let start = spokes.get(ends[0] as usize).copied().unwrap_or(NONE);
    if start == NONE || ends[1] as usize >= positions.len() {
        return Err(ConstrainError::NotAVertex { constraint: 0, vertex: ends[usize::from(start != NONE)] });
    }
    let mut chain = TriangleChain { triangles: Vec::new(), configurations: Vec::new() };
    let lost = ConstrainError::Lost { ends };
    let first = match depart_by_turning(mesh, positions, start, ends[1]) {
        Some(Departure::Across(h)) => h,
        Some(Departure::Along(h)) if mesh.destination(h) == ends[1] => return Ok(chain),
        Some(Departure::Along(h)) => {
            return Err(ConstrainError::ThroughVertex { sub_constraint: ends, vertex: mesh.destination(h) });
        }
        None => return Err(lost),
    };
    let line = ends.map(|v| positions[v as usize]);
    let (mut h, mut near) = (first, (ends[0], 0));
    chain.triangles.push(first / 3);
    for _ in 0..mesh.slots() {
        let Some((g, side)) = enter(mesh, positions, h, line) else { return Err(lost) };
        let far = (mesh.apex(g), side as Side);
        chain.triangles.push(g / 3);
        chain.configurations.push(configuration(positions, [near, far], [mesh.origin(h), mesh.destination(h)]));
        if far.0 == ends[1] {
            return Ok(chain);
        }
        if side == Sign::Zero {
            return Err(ConstrainError::ThroughVertex { sub_constraint: ends, vertex: far.0 });
        }
        h = leave(g, side);
        // If the apex lies left, the triangle is left across the edge from the right corner to the apex, so that its
        // corner off that edge lies left too; and likewise on the right.
        near = (mesh.apex(h), side as Side);
    }
    Err(lost)
}
