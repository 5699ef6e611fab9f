//! What each kernel does, under its name.

mod insert;
mod walk;

pub use insert::*;
pub use walk::*;
