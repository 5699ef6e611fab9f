//! The tests of stages 2 to 4.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;
mod errors;
mod fuzz;
mod lemmas;
mod pitfalls;
mod properties;
mod shifting;
mod snapshots;
