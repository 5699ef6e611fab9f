//! What the kernels must give, bit for bit, as plain Rust on slices: each kernel by its name, and each primitive as a
//! whole.

mod kernels;
mod primitives;

pub use kernels::*;
pub use primitives::*;
