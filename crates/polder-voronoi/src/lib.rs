//! Stage 1: the digital Voronoi diagram of a point set.
//!
//! | in | out |
//! |---|---|
//! | points, finite f64 of any magnitude | a [`GridMapping`] between the plane and a grid of pixels, exact both ways |
//! | | [`Sites`]: which points own a pixel, and all points renumbered in pixel order |
//! | | a [`Diagram`]: the color (site number) of every pixel, as flooding from the sites gives it |
//!
//! [`reference::diagram`] runs the whole stage; its steps stand beside it for use one by one: [`reference::map`],
//! [`reference::color`], [`reference::debris`], [`reference::recolor`]. [`gpu::Stage`] does the same on a Vulkan device.
//!
//! # Guarantees
//!
//! - Every step is a pure function of its input, computed in integers alone.
//! - A point lies in its pixel exactly: different columns (rows) mean strictly ordered coordinates, for points and for
//!   pixel centers in any mixture. Pixel centers are f64 values without rounding.
//! - The finished diagram is pixel by pixel that of flooding ([`reference::flooding`]), whose regions are connected,
//!   have no holes, and dualize to a valid triangulation.
//!
//! # Sources
//!
//! \[QCT\] section 3.1, Appendix A and B; \[CET\] sections 2 and 3.1. Full entries are in `references.bib`.
#![forbid(unsafe_code)]

mod bounds;
mod diagram;
mod error;
pub mod gpu;
pub mod kernels;
mod mapping;
mod occupancy;
mod order;
pub mod reference;
mod sites;
mod text;

pub use bounds::Bounds;
pub use diagram::{Counts, Diagram, UNCOLORED};
pub use error::VoronoiError;
pub use glam::DVec2;
pub use mapping::{GridMapping, MAX_SIDE, Options, Resolution};
pub use occupancy::Occupancy;
pub use order::Key;
pub use sites::Sites;
pub use text::Letters;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
