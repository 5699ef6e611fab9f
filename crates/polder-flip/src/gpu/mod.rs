//! The stage on the device, and the working mesh that stages share there.

mod mesh;

pub use mesh::{CONSTRAINED, HALF_EDGE, MOST_SLOTS, Mesh};
