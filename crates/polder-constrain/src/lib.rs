//! Stage 6: constraints inserted by flips, crossings named.
//!
//! | step | what goes in | what comes out |
//! |---|---|---|
//! | [`reference::walk`] | a triangulation without constraints, constraints as pairs of vertices | [`Walk`]: the constraints cut at vertices into sub-constraints, and each one's chain of vertices |
//! | [`reference::crossings`] | the same, walked | [`Crossings`]: the pairs of constraints that cross where no vertex is |
//! | [`reference::insert`] | any triangulation, sub-constraints that do not cross | the triangulation with every sub-constraint as a constrained edge |
//! | [`polder_flip`] | that | the constrained Delaunay triangulation |
//!
//! [`reference::constrain`] is all four in a row. All of it works on a [`GhostMesh`](polder_mesh::GhostMesh) whose
//! finite triangles are strictly counterclockwise and whose hull is convex; all points on one line (a mesh of ghost
//! triangles alone) is such a mesh too.
#![forbid(unsafe_code)]

mod crossings;
mod error;
pub mod gpu;
mod insertion;
pub mod kernels;
pub mod reference;
mod walk;

pub use crossings::Crossings;
pub use error::ConstrainError;
pub use insertion::{Fault, InsertReport};
pub use walk::Walk;
