//! The stage on the device, bit for bit what [`reference`](crate::reference) gives.
//!
//! [`Stage`] holds the kernels, [`Buffers`] the memory for one size. Recording appends work and does nothing else: it
//! allocates nothing, submits nothing and waits for nothing.
//!
//! 1. *Mapping* (\[QCT\] section 3.1): points to pixels in integers alone; a bit for each pixel that has a point. How many
//!    bits stand before each word, a scan, is the number of its first site: the lowest index of a pixel keeps it by an
//!    atomic minimum at the site's number. Whoever loses there gets a bit of its own; the missing points, out of these
//!    bits in the order of their indices, are sorted, stably, by the number of the site in their pixel.
//! 2. *Coloring*, tile by tile in shared memory: the nearest site of a pixel's own row lies at the next set bit to the left
//!    or right; then rows are looked at up and down as far as the best site so far is away. That is exact where some site
//!    lies within [`Tuning::radius`]. Tiles with pixels, in them or next to them, for which none does are left to the
//!    Parallel Banding Algorithm. Columns: first and last site of each band of rows, then every pixel's nearest row.
//!    Rows: proximate sites of each band of columns as a stack; the stacks of a row are merged from left to right, some
//!    neighbors at once and then these, which takes from the ends that meet and touches nothing inside; each pixel searches
//!    the entry that wins it.
//! 3. *Repair*: the coloring has marked the pixels without a closer neighbor of their color. They are debris and lose it;
//!    neighbors may thereby become debris; and so on until there is none. Then debris takes the best color on offer, and
//!    looks again where a neighbor has changed, until nothing does (\[QCT\] Appendix A). The first turns of both are shared by
//!    all workgroups, the rest is left to one, which needs no dispatch between two rounds.
//!
//! Departures: entries of the stacks carry the first pixel that they win, which is exact in integers, so that ties go by
//! the total order of [`Key`](crate::Key) in every step, and the last step is a search and not a walk. Recoloring reads and
//! writes colors in place: rounds are not those of the reference, and what they end in is (proof at
//! [`reference::recolor`](crate::reference::recolor): only one coloring stays as it is).

mod bounds;
mod buffers;
mod cells;
mod record;
mod results;

pub use bounds::{BoundsRead, FindBounds};
pub use buffers::{Buffers, CountsRead};
pub use cells::{FindOccupancy, OccupancyRead};
pub use results::Results;

use crate::kernels::*;
use polder_vulkan::{Device, Error, Estimate, Kernel};
use record::ROWS;

/// Lengths that change the time and nothing else. How the defaults were chosen is told, with figures, in the crate's README.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tuning {
    /// How far the search around a pixel goes: a multiple of 4, at most 28. With 0 all is left to the bands.
    pub radius: u32,
    /// Rows of a band, at least 1.
    pub rows: u32,
    /// Columns of a band, between 1 and 64.
    pub columns: u32,
    /// Invocations that share a tile.
    pub tile_lanes: u32,
    /// Rows of a workgroup that makes stacks.
    pub row_lanes: u32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self { radius: 24, rows: 62, columns: 32, tile_lanes: 256, row_lanes: 32 }
    }
}

impl Tuning {
    fn clamped(self) -> Self {
        Self {
            radius: self.radius.min(28) / 4 * 4,
            rows: self.rows.clamp(1, crate::MAX_SIDE),
            columns: self.columns.clamp(1, 64),
            ..self
        }
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    tuning: Tuning,
    map_points: Kernel<MapPoints>,
    count_bits: Kernel<CountBits>,
    elect_sites: Kernel<ElectSites>,
    list_sites: Kernel<ListSites>,
    list_missing: Kernel<ListMissing>,
    number_missing: Kernel<NumberMissing>,
    color_tiles: Kernel<ColorTiles>,
    plan_bands: Kernel<PlanBands>,
    column_ends: Kernel<ColumnEnds>,
    column_fill: Kernel<ColumnFill>,
    row_stacks: Kernel<RowStacks>,
    row_merge: Kernel<RowMerge>,
    color_pixels: Kernel<ColorPixels>,
    mark_debris: Kernel<MarkDebris>,
    list_debris: Kernel<ListDebris>,
    spread_debris: Kernel<SpreadDebris>,
    recolor_debris: Kernel<RecolorDebris>,
    repair: Kernel<Repair>,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_tuning(device, Tuning::default())
    }

    /// With other lengths: for measurements and tests.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn with_tuning(device: &Device, tuning: Tuning) -> Result<Self, Error> {
        let tuning = tuning.clamped();
        let repairers = device.info().limits.workgroup_invocations.min(1024);
        Ok(Self {
            device: device.clone(),
            tuning,
            map_points: Kernel::new(device, &[])?,
            count_bits: Kernel::new(device, &[])?,
            elect_sites: Kernel::new(device, &[])?,
            list_sites: Kernel::new(device, &[])?,
            list_missing: Kernel::new(device, &[])?,
            number_missing: Kernel::new(device, &[])?,
            color_tiles: Kernel::new(device, &[("RADIUS", tuning.radius), ("WORKGROUP", tuning.tile_lanes)])?,
            plan_bands: Kernel::new(device, &[("WORKGROUP", 1)])?,
            column_ends: Kernel::new(device, &[])?,
            column_fill: Kernel::new(device, &[])?,
            row_stacks: Kernel::new(device, &[("WORKGROUP", tuning.row_lanes), ("BAND", tuning.columns)])?,
            row_merge: Kernel::new(device, &[("WORKGROUP", ROWS)])?,
            color_pixels: Kernel::new(device, &[])?,
            mark_debris: Kernel::new(device, &[])?,
            list_debris: Kernel::new(device, &[])?,
            spread_debris: Kernel::new(device, &[])?,
            recolor_debris: Kernel::new(device, &[])?,
            repair: Kernel::new(device, &[("WORKGROUP", repairers)])?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(&self, points: usize, size: [u32; 2]) -> Estimate {
        buffers::estimate(&self.device, points, size, self.tuning)
    }

    /// Memory for so many points, at least one, and a grid of this size.
    ///
    /// # Errors
    ///
    /// If the numbers are impossible, or the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, points: usize, size: [u32; 2]) -> Result<Buffers, Error> {
        Buffers::new(&self.device, points, size, self.tuning)
    }
}
