//! The constrained Delaunay triangulation of points and segments in the plane: exact, canonical, fast.
//!
//! ```
//! use polder::{DVec2, Options, Pslg, triangulate};
//!
//! let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (1.0, 1.0)].map(DVec2::from);
//! let pslg = Pslg::new(points.to_vec(), vec![[0, 2]])?;
//! let output = triangulate(&pslg, &Options::default())?;
//! assert_eq!(output.triangulation.triangles(), [[0, 1, 2], [0, 2, 4], [0, 4, 3], [2, 3, 4]]);
//! assert!(output.triangulation.edges().any(|edge| edge.constrained));
//! # Ok::<(), polder::Error>(())
//! ```
//!
//! # Promises
//!
//! 1. **Exact.** Every sign that geometry depends on is the true one, for every finite `f64`.
//! 2. **Canonical.** The same input gives the same triangles, byte for byte: on every backend, with any number of
//!    threads. Ties between cocircular points are broken by position, so that the order of the points does not matter
//!    either.
//! 3. **Nothing is lost silently.** Every point is a vertex or a [duplicate](Triangulation::duplicates) of one; every
//!    constraint is a [chain](Triangulation::chain) of edges; constraints that cross are all named.
//! 4. **It never panics or hangs.** Bad input is a typed [`Error`] with the index at fault; every loop has a bound;
//!    [`Options::cancel`] stops it.
//!
//! The triangulation covers the convex hull of the points; [`regions`] says what lies inside an outline, and leaves out
//! the rest. No points, one, two, all equal, or all on one line: a valid
//! empty triangulation.
//!
//! # Ways
//!
//! [`Backend::Cpu`] is the fast way on a CPU; [`Backend::Vulkan`] is the whole pipeline on a GPU, which [`Gpu`] keeps open for
//! more than one call; [`Backend::Reference`] runs the stages of the GPU pipeline as plain Rust,
//! and [`stages()`] shows all that they pass on to each other. [`verify`] checks any mesh, exactly.
#![forbid(unsafe_code)]

mod cpu;
mod error;
mod gpu;
mod options;
mod plan;
mod reference;
pub mod regions;
mod report;
mod split;
mod stages;
pub mod verify;

pub use error::Error;
pub use gpu::{AUTO_FROM, ChainsOnDevice, Gpu, OnDevice};
pub use options::{Backend, CrossingPolicy, Options, ProgressFn};
pub use polder_mesh::{
    AddedVertex, Chains, ConstraintId, DVec2, Digest, Edge, EdgeId, MeshError, Progress, Pslg, TriangleId,
    Triangulation, VertexId,
};
/// The compute engine: what devices there are.
pub use polder_vulkan as vulkan;
pub use report::{ConstraintReport, DeviceReport, KernelReport, Output, Place, PointReport, Report, StageReport};
pub use stages::{Stages, stages};
/// The crates of the stages, whose types [`Stages`] holds.
pub use {
    polder_canonical as canonical, polder_constrain as constrain, polder_dualize as dualize, polder_flip as flip,
    polder_voronoi as voronoi,
};

/// Triangulates the whole convex hull of a PSLG's points, with every constraint as edges.
///
/// The result does not depend on the options: they choose the way, not the answer; but for [`Options::crossings`], which
/// says what becomes of constraints that cross. Where they are split, [`Triangulation::added`] lists the new vertices,
/// behind the input's points.
///
/// # Errors
///
/// - [`Error::CrossingConstraints`] names all pairs of constraints that cross at a point inside both that is no vertex,
///   up to [`Options::max_crossings`].
/// - [`Error::SplitTooLarge`], [`Error::SplitUnfinished`] where they shall be split but cannot.
/// - [`Error::Unsupported`] if the backend asked for, or the number of threads or pixels, cannot be had.
/// - [`Error::Cancelled`] if the caller said so.
/// - [`Error::BoundExceeded`] and [`Error::Internal`] are defects of polder, reported instead of a hang or a wrong answer.
pub fn triangulate(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    match options.backend {
        Backend::Auto => gpu::auto(pslg, options),
        Backend::Cpu => split::by_policy(pslg, options, Place::Cpu, cpu::triangulate),
        Backend::Reference => split::by_policy(pslg, options, Place::Cpu, reference::triangulate),
        Backend::Vulkan => gpu::vulkan(pslg, options),
    }
}

/// The README's example compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
