//! The stage in plain Rust. [QCT] section 4.

mod chords;
mod crossings;
mod exact;
mod fan;
mod walk;

pub use crossings::crossings;
pub use walk::walk;

use crate::ConstrainError;
use glam::DVec2;
use polder_mesh::{DELETED, GhostMesh};

pub(crate) fn check_positions(mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), ConstrainError> {
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v < DELETED && v as usize >= positions.len()) {
            return Err(ConstrainError::MissingPosition { triangle, vertex, positions: positions.len() });
        }
    }
    Ok(())
}
