//! The stage on a device.

pub mod walk;
