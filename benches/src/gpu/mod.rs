//! What runs on a Vulkan device, measured by timestamps around each kernel.
//!
//! A card that has waited for the host runs slowly at first, so every recording runs for a while before it is timed. The
//! floor is what must be read and written once, at the speed at which the same card copies an array in the same run.

pub(crate) mod constrained;
pub(crate) mod delaunay;
mod device;
pub(crate) mod voronoi;
mod whole;

pub(crate) use device::{DeviceFacts, Measured, OnDevice};

use polder::Pslg;
use std::path::Path;

/// What a file holds.
pub(crate) fn read(file: &Path) -> Result<Pslg, String> {
    polder_io::Input::read(file).map(|input| input.pslg).map_err(|error| error.to_string())
}

/// What to call it.
pub(crate) fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

/// Milliseconds.
pub(crate) fn ms(seconds: f64) -> f64 {
    seconds * 1e3
}
