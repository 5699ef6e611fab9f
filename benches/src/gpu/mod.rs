//! What runs on a Vulkan device, measured by timestamps around each kernel.
//!
//! A card that has waited for the host runs slowly at first, so every recording runs for a while before it is timed. The
//! floor is what must be read and written once, at the speed at which the same card copies an array in the same run.

pub(crate) mod delaunay;
mod device;
pub(crate) mod voronoi;

pub(crate) use device::{DeviceFacts, Measured, OnDevice};

/// Milliseconds.
pub(crate) fn ms(seconds: f64) -> f64 {
    seconds * 1e3
}
