//! Walking around a vertex.

use crate::DualizeError;
use polder_mesh::{GhostMesh, NONE};

/// The half-edges out of the origin of `start`, counterclockwise, each once; empty if `start` is [`NONE`].
///
/// In a broken mesh the walk may never come back, so it stops after as many steps as there are half-edges.
pub(super) fn star(mesh: &GhostMesh, start: u32) -> impl Iterator<Item = u32> + '_ {
    let mut h = start;
    let limit = if start == NONE { 0 } else { 3 * mesh.slots() };
    (0..limit).map_while(move |step| {
        if step > 0 {
            h = mesh.rotate_ccw(h);
        }
        (step == 0 || h != start).then_some(h)
    })
}

/// The error for a star that is not what a triangulation has.
pub(super) fn broken(stage: &'static str, vertex: u32) -> DualizeError {
    DualizeError::Broken { stage, vertex }
}
