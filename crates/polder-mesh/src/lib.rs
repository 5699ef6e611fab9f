//! The data that flows through polder, and nothing that computes geometry.
//!
//! | type | what it is |
//! |---|---|
//! | [`Pslg`] | the input: points and constraints, validated |
//! | [`GhostMesh`] | the working mesh of the stages: triangles, links, ghost triangles around the hull |
//! | [`Triangulation`] | the output: triangles in canonical order, neighbors, constrained edges, what became of every point and constraint |
//!
//! [`Regions`] are what constrained edges divide a triangulation into.
//!
//! This crate knows no predicates: topology takes ids, and whoever calls it has decided the geometry before.
//!
//! # Conventions
//!
//! - Corner `k` of a triangle lies opposite its edge `k` and its neighbor `k`. Edge `k` runs from corner
//!   `k + 1` to corner `k + 2` (modulo 3), and the triangle lies on its left.
//! - A *half-edge* is the number `3 * t + k` of edge `k` of triangle `t`.
#![forbid(unsafe_code)]

mod added;
mod canonical;
mod chains;
mod digest;
mod error;
mod ghost;
mod ids;
mod monitor;
mod pslg;
mod regions;
mod text;
mod triangulation;

pub use added::AddedVertex;
pub use canonical::Slot;
pub use chains::Chains;
pub use digest::Digest;
pub use error::MeshError;
pub use ghost::{DELETED, GHOST, GhostMesh, NONE, next, prev, twin_code};
pub use ids::{ConstraintId, EdgeId, TriangleId, VertexId};
pub use monitor::{Cancelled, Monitor, Progress};
pub use pslg::{Constraint, Pslg};
pub use regions::Regions;
pub use triangulation::{Arrays, Edge, Parts, Triangulation};

pub use glam::DVec2;
