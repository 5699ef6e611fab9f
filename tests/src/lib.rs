//! Shared helpers of the workspace tests: the input families, and shuffles that a canonical result must not notice.
#![forbid(unsafe_code)]

mod families;
mod random;
mod shuffle;

pub use families::{constrained_families, families, point_families};
pub use random::random;
pub use shuffle::{Shuffled, canonical_digest, canonical_triangles, classes, shuffled};
