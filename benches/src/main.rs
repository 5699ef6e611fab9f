//! What `cargo xtask bench` runs.
#![forbid(unsafe_code)]

fn main() {}
