//! The stages in plain Rust on slices: the same rounds with the same winners as on any other device.
//!
//! [`dual()`], [`shift()`] and [`insert()`] in order; [`triangulate`] is all of them after stage 1.

mod bootstrap;
mod certify;
mod corners;
mod dualize;
pub(crate) mod elect;
mod insert;
pub mod kernels;
mod key;
mod locate;
mod sector;
mod shift;
mod star;
mod takeout;
#[cfg(test)]
mod tests;
mod whole;

pub use certify::certify;
pub use dualize::{dual, dualize};
pub use insert::{ToInsert, insert, insert_with};
pub use shift::{shift, shift_with};
pub use whole::{Phases, centers, points_to_insert, triangulate};
