//! Tests of the stage: the mapping, the coloring, debris, and the lemmas about flooding.
#![forbid(unsafe_code)]
#![allow(clippy::unwrap_used, reason = "tests")]

mod cases;
mod coloring;
mod errors;
mod flooding;
mod lemmas;
mod mapping;
mod snapshots;
