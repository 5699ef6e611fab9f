//! The constrained Delaunay triangulation of a planar straight-line graph: exact, canonical, fast.
#![forbid(unsafe_code)]

mod cpu;
mod error;
mod options;
mod report;

pub use error::Error;
pub use options::{Backend, Options, ProgressFn};
pub use polder_mesh::{
    Chains, ConstraintId, DVec2, Digest, EdgeId, MeshError, Progress, Pslg, TriangleId, Triangulation, VertexId,
};
pub use report::{ConstraintReport, Output, PointReport, Report, StageReport};

/// Triangulates.
///
/// # Errors
///
/// See [`Error`].
pub fn triangulate(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    match options.backend {
        Backend::Auto | Backend::Cpu => cpu::triangulate(pslg, options),
        Backend::Reference => Err(Error::Unsupported { what: "the reference pipeline".into() }),
        Backend::Vulkan => Err(Error::Unsupported { what: "the Vulkan backend is not there yet; use the CPU".into() }),
    }
}
