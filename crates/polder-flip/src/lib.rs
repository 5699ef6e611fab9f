//! Stage 5: flips to the constrained Delaunay triangulation.
//!
//! What goes in: a [`GhostMesh`](polder_mesh::GhostMesh), whose finite triangles are all strictly counterclockwise, and
//! the position of each vertex. What comes out: the same mesh after flips, with a convex hull, in which no edge but
//! constrained ones is illegal. Its finite triangles are then *the* constrained Delaunay triangulation of the vertices
//! and constrained edges: ties between cocircular points are settled by
//! [`must_flip`](polder_predicates::must_flip), so that neither the triangulation at the start nor the order of the
//! flips shows in the result.
//!
//! [`reference`](mod@reference) is the stage in plain Rust: the same rounds, winners and slots as on any other device.
//!
//! The other stages borrow two things from here: the order in which conflicts are settled ([`priority()`]), and single
//! flip rounds ([`reference::flip_round`]).
#![forbid(unsafe_code)]

mod error;
pub mod gpu;
pub mod kernels;
mod priority;
pub mod reference;

pub use error::FlipError;
pub use priority::priority;

/// What flips cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FlipReport {
    /// Rounds, the last one (which found nothing to flip) included.
    pub rounds: u64,
    /// Edges flipped.
    pub flips: u64,
    /// Edges tested; on a GPU also those that the round before has shown to be illegal, and that are not tested again.
    pub tests: u64,
}

impl std::ops::AddAssign for FlipReport {
    fn add_assign(&mut self, other: Self) {
        self.rounds += other.rounds;
        self.flips += other.flips;
        self.tests += other.tests;
    }
}

/// One line: `rounds 3, flips 5, tests 40`.
impl std::fmt::Display for FlipReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rounds {}, flips {}, tests {}", self.rounds, self.flips, self.tests)
    }
}
