//! The stage on a device, bit for bit what [`reference`](mod@crate::reference) gives.

pub mod insert;
pub mod pieces;
pub mod walk;
