//! File formats and generators of planar straight-line graphs.
#![forbid(unsafe_code)]

pub mod generate;
