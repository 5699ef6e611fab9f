//! Stages 2 to 4: from a digital Voronoi diagram to a triangulation of all points.
//!
//! | stage | in | out |
//! |---|---|---|
//! | 2, [`reference::dual`] | a [`Diagram`](polder_voronoi::Diagram) and its [`Sites`](polder_voronoi::Sites) | [`Dualized`]: a triangulation of the sites at their pixels; [`reference::dualize`] also makes its hull convex |
//! | 3, [`reference::shift`] | that mesh, the pixel centers, the true positions | [`Shifted`]: a triangulation of most sites at their true positions, and an heir for each site taken out |
//! | 4, [`reference::insert`] | that mesh, all positions, the points to be put in and where to start looking for each | [`Inserted`]: a triangulation of all distinct points, and the vertex that each point became |
//!
//! [`reference::triangulate`] runs stage 1 and these three, for whoever wants a triangulation of points and nothing
//! else. The result is a triangulation, not yet the Delaunay one: that is stage 5, in `polder-flip`.
//!
//! Vertices carry the numbers of the renumbering in [`Sites`](polder_voronoi::Sites) throughout;
//! [`Inserted::names`] leads back to the input.
//!
//! # Guarantees
//!
//! - Every stage is a pure function of its input, and every decision that needs more than an exact sign is integer
//!   arithmetic.
//! - Stages 3 and 4, and [`reference::dualize`], end with a certificate, checked in exact arithmetic: every finite
//!   triangle is strictly counterclockwise, and the hull is nowhere reflex and winds round exactly once. Together these
//!   say that the triangles cover the convex hull without overlap (see [`reference::certify`]). What fails it is an
//!   error, never a result.
//! - Sites or points that all lie on one line are no error: the mesh is then a chain, with ghost triangles on both
//!   sides of each of its edges and no finite one; with fewer than two distinct points it is empty.
//!
//! # Sources
//!
//! \[CET\] sections 2 and 3.3; \[QCT\] sections 3.2 to 3.4. Full entries are in `references.bib`.
#![forbid(unsafe_code)]

mod error;
pub mod gpu;
pub mod kernels;
mod outcome;
pub mod reference;

pub use error::DualizeError;
pub use glam::DVec2;
pub use outcome::{Dualized, Inserted, Shifted};
