//! The stage in plain Rust. \[QCT\] section 4: first [`walk`](walk()), then [`crossings`](crossings()), then
//! [`insert`](insert()), then flips.
//!
//! # Before the flips
//!
//! Constraints are inserted into the triangulation as stage 4 leaves it, then one flip to the constrained Delaunay
//! triangulation follows. The result would be the same after a flip before as well, at a higher price, since flips that
//! insertion makes useless are made all the same. With constraints of all lengths:
//!
//! | points | constraints | order | intersections | flips before | flips to insert | flips after | all |
//! |---|---|---|---|---|---|---|---|
//! | 100,000 | 10,000 | insert, flip | 72,453 | - | 69,200 | 29,140 | 98,340 |
//! | 100,000 | 10,000 | flip, insert, flip | 71,126 | 30,990 | 67,693 | 10,910 | 109,593 |
//! | 1,000,000 | 100,000 | insert, flip | 726,223 | - | 696,036 | 289,681 | 985,717 |
//! | 1,000,000 | 100,000 | flip, insert, flip | 713,505 | 303,902 | 681,713 | 111,443 | 1,097,058 |
//!
//! So an intersection costs about one flip, before the triangulation is Delaunay as well as after.

mod chords;
mod configuration;
mod crossings;
mod exact;
mod fan;
mod inner;
mod insert;
mod intersection;
pub mod kernels;
mod keys;
mod limits;
mod near;
mod pairs;
mod pairwise;
mod place;
mod rebuild;
mod walk;

pub use configuration::{Configuration, TriangleChain, triangle_chain};
pub use crossings::crossings;
#[doc(hidden)]
pub use inner::Trial;
pub use insert::{Insertion, insert};
pub use intersection::intersection;
pub use keys::{claim_key, owner_of, owner_priority};
pub use limits::{
    HUB, HUB_WALK, INNER_ROUNDS, LEAST_REBUILT, LONG_CHAIN, LONGEST_REBUILT, MOST_SPOKES, MOST_SUB_CONSTRAINTS,
    MOST_TIMES, USUAL_ROUNDS,
};
pub use near::near;
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
