//! The stage on the device, and the working mesh that stages share there.

mod mesh;
mod predicates;

pub use mesh::{CONSTRAINED, HALF_EDGE, MOST_SLOTS, Mesh};
pub use predicates::{Arithmetic, Kernels, Signs, SignsBuffers};
