use polder_mesh::Cancelled;
use thiserror::Error;

/// Why a mesh could not be flipped to the end.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FlipError {
    /// A corner of the mesh has no position.
    #[error("triangle {triangle}: its corner {vertex} has no position, there are only {positions}")]
    MissingPosition {
        /// The first triangle with such a corner.
        triangle: usize,
        /// The corner.
        vertex: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// More rounds than a triangulation of this size can need: the mesh was not a triangulation.
    #[error("{stage}: edges are still illegal after {rounds} rounds, the bound for {triangles} triangles")]
    BoundExceeded {
        /// `"flip"` or `"close hull"`.
        stage: &'static str,
        /// How many rounds were made.
        rounds: u64,
        /// How many triangles the mesh has, ghosts included.
        triangles: usize,
    },
    /// The caller wants no more rounds.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
