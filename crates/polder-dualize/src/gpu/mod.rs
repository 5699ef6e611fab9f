//! The stages on the device, bit for bit what [`reference`](crate::reference) gives.

pub mod dualize;
pub mod insert;
pub mod shift;
mod shift_buffers;
mod takeout;
pub mod to_insert;
