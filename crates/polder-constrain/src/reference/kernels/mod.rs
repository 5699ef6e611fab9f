//! What each kernel does, under its name.

mod walk;

pub use walk::*;
