//! The stage as plain Rust on slices: what the kernels must reproduce bit for bit.
//!
//! The steps in order: [`map`], [`color`], [`debris`], [`recolor`]; [`diagram`] is all of them.

mod bounds;
mod cells;
mod color;
mod debris;
pub mod flooding;
pub mod kernels;
mod map;
mod recolor;

pub use bounds::{bound_partials, bound_points};
pub use cells::{count_cells, mark_cells};
pub use color::color;
pub use debris::debris;
pub use map::{elect, map};
pub use recolor::{recolor, recolor_by_queue};

use crate::{Counts, Diagram, GridMapping, Options, Sites, VoronoiError};
use glam::DVec2;

/// What [`diagram`] gives: the grid, the sites and the finished diagram, with what was counted on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// The grid.
    pub mapping: GridMapping,
    /// Which points own a pixel, and the renumbering.
    pub sites: Sites,
    /// The diagram, debris recolored.
    pub diagram: Diagram,
    /// What was counted.
    pub counts: Counts,
}

/// The whole stage: maps the points, colors the grid, and recolors debris.
///
/// # Errors
///
/// Those of [`GridMapping::fit`].
pub fn diagram(points: &[DVec2], options: &Options) -> Result<Output, VoronoiError> {
    let mapping = GridMapping::fit(points, options)?;
    let sites = map(points, &mapping)?;
    let mut diagram = color(&sites)?;
    debris(&mut diagram, &sites)?;
    recolor(&mut diagram, &sites)?;
    let counts = Counts {
        points: points.len() as u64,
        pixels: diagram.colors.len() as u64,
        sites: sites.count as u64,
        missing: sites.missing() as u64,
        debris: diagram.debris.len() as u64,
    };
    Ok(Output { mapping, sites, diagram, counts })
}
