//! Shared helpers of the workspace tests: the input families and inputs of any kind, what two backends have to have in common, and
//! shuffles that a canonical result must not notice.
#![forbid(unsafe_code)]

mod families;
mod random;
mod same;
mod shuffle;

pub use families::{constrained_families, families, point_families};
pub use random::random;
pub use same::assert_same_output;
pub use shuffle::{Shuffled, canonical_digest, canonical_triangles, classes, shuffled};
