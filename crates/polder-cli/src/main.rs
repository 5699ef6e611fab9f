//! The command polder.
#![forbid(unsafe_code)]

fn main() {}
