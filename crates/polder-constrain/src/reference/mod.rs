//! The stage in plain Rust. [QCT] section 4: first [`walk`], then [`crossings()`], then [`insert`], then flips.
//!
//! # The order of insertion and flips
//!
//! Constraints are inserted into the triangulation as it comes, and one flip to the constrained Delaunay triangulation
//! follows.

mod chords;
mod configuration;
mod crossings;
mod exact;
mod fan;
mod inner;
mod insert;
mod walk;

pub use configuration::{Configuration, TriangleChain, triangle_chain};
pub use crossings::crossings;
#[doc(hidden)]
pub use inner::Trial;
pub use insert::{INNER_ROUNDS, Insertion, insert};
pub use walk::walk;

use crate::{ConstrainError, InsertReport, Walk};
use glam::DVec2;
use polder_flip::FlipReport;
use polder_mesh::{DELETED, GhostMesh};

/// From a triangulation and constraints to the constrained Delaunay triangulation: all steps in a row.
///
/// # Errors
///
/// [`ConstrainError::CrossingConstraints`] with the pairs that cross, at most `max_crossings` of them; the errors of the
/// single steps. The mesh is not changed if the constraints cross.
pub fn constrain(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    constraints: &[[u32; 2]],
    max_crossings: usize,
) -> Result<(Walk, InsertReport, FlipReport), ConstrainError> {
    let walked = walk(mesh, positions, constraints)?;
    let crossing = crossings(mesh, positions, &walked, max_crossings)?;
    if crossing.truncated || !crossing.pairs.is_empty() {
        return Err(ConstrainError::CrossingConstraints(crossing));
    }
    let inserted = insert(mesh, positions, &walked.sub_constraints)?;
    let flipped = polder_flip::reference::flip(mesh, positions)?;
    Ok((walked, inserted, flipped))
}

/// Replaces the ends of constraints by the vertices that stand for them, where points are duplicates of others.
pub fn rename(constraints: &[[u32; 2]], representatives: &[u32]) -> Vec<[u32; 2]> {
    constraints.iter().map(|c| c.map(|v| representatives.get(v as usize).copied().unwrap_or(v))).collect()
}

pub(crate) fn check_positions(mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), ConstrainError> {
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v < DELETED && v as usize >= positions.len()) {
            return Err(ConstrainError::MissingPosition { triangle, vertex, positions: positions.len() });
        }
    }
    Ok(())
}
