use polder_flip::FlipError;
use polder_mesh::Cancelled;
use polder_voronoi::VoronoiError;
use thiserror::Error;

/// What can go wrong in stages 2 to 4.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DualizeError {
    /// The parts handed to a stage do not belong together.
    #[error("{what}, at index {index}")]
    Mismatch {
        /// What does not fit.
        what: &'static str,
        /// The pixel, site or point at fault.
        index: usize,
    },
    /// Two regions cross at a corner of the grid: the coloring is not one that flooding gives.
    #[error("two necks cross at grid corner [{x}, {y}]: the diagram is not a flooded one")]
    CrossingNecks {
        /// Column of the corner, counted in pixel sides.
        x: u32,
        /// Row of the corner.
        y: u32,
    },
    /// The dual has too many or too few triangles to be a sphere: some region is not connected, or has a hole.
    #[error("{triangles} triangles dual to {sites} sites, not {expected}: some region is not simply connected")]
    NotASphere {
        /// How many triangles there are, ghosts included.
        triangles: usize,
        /// How many sites there are.
        sites: usize,
        /// How many triangles a sphere with these vertices has.
        expected: usize,
    },
    /// The links of a mesh contradict each other around a vertex or triangle.
    #[error("{stage}: the mesh is broken around vertex {vertex}")]
    Broken {
        /// The stage that noticed.
        stage: &'static str,
        /// The vertex.
        vertex: u32,
    },
    /// A finite triangle is not strictly counterclockwise.
    #[error("{stage}: triangle {triangle} is not counterclockwise")]
    NotCounterclockwise {
        /// The stage whose certificate failed.
        stage: &'static str,
        /// The slot of the first such triangle.
        triangle: usize,
    },
    /// The hull turns right at a vertex, or folds back there.
    #[error("{stage}: the hull is not convex at vertex {vertex}")]
    HullNotConvex {
        /// The stage whose certificate failed.
        stage: &'static str,
        /// The vertex.
        vertex: u32,
    },
    /// The hull is nowhere reflex, but winds round more than once.
    #[error("{stage}: the hull winds round {times} times")]
    HullWinds {
        /// The stage whose certificate failed.
        stage: &'static str,
        /// How often.
        times: usize,
    },
    /// A walk through the triangulation did not come to its end.
    #[error("locating point {point}: no end after {steps} steps")]
    WalkLost {
        /// The point looked for.
        point: u32,
        /// How many steps were made.
        steps: u64,
    },
    /// A loop ran past the bound that its input gives it. This is a bug in this crate.
    #[error("{stage}: more than {bound} rounds")]
    BoundExceeded {
        /// The loop.
        stage: &'static str,
        /// The bound.
        bound: u64,
    },
    /// Flips failed.
    #[error(transparent)]
    Flip(#[from] FlipError),
    /// Stage 1 failed.
    #[error(transparent)]
    Voronoi(#[from] VoronoiError),
    /// The caller wants no more rounds.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
