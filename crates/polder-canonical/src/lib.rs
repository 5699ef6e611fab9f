//! The last step: a working mesh becomes a triangulation in canonical order, in the numbering of the input, certified.
//!
//! What goes in: a [`GhostMesh`](polder_mesh::GhostMesh) whose vertices have the numbers of the stages; for each point the
//! vertex that it is or equals, and its input index. What comes out: what
//! [`Triangulation`](polder_mesh::Triangulation) holds. Each triangle starts at its smallest corner and goes
//! counterclockwise; triangles are sorted by their corners; neighbors name triangles of that order.
//!
//! The certificate ([`reference::certify`]) says of the mesh that its finite triangles cover the convex hull of all
//! vertices without overlap. It says nothing of the Delaunay property, which flips end with.
//!
//! [`mod@reference`] is plain Rust; [`gpu`] gives the same bits on a Vulkan device.
#![forbid(unsafe_code)]

mod error;
pub mod gpu;
pub mod kernels;
pub mod reference;

pub use error::CanonicalError;
