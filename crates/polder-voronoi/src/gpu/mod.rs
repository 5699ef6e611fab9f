//! The stage on the device, bit for bit what [`reference`](crate::reference) gives.
//!
//! [`Stage`] holds the kernels, [`Buffers`] the memory for one size. Recording appends work and does nothing else: it
//! allocates nothing, submits nothing and waits for nothing.
//!
//! 1. *Mapping* (\[QCT\] section 3.1): points to pixels in integers alone, the lowest index keeps a pixel by an atomic
//!    minimum; a scan over the owned pixels numbers the sites, a stable sort by pixel index the missing points.
//! 2. *Coloring* by the Parallel Banding Algorithm. Columns: first and last site of each band of rows, then every pixel's
//!    nearest row. Rows: proximate sites of each band of columns as a stack; the stacks of a row are merged from left to
//!    right, which takes from the ends that meet and touches nothing inside; each pixel searches the entry that wins it.
//! 3. *Repair*: debris is marked in rounds over lists, then recolored in rounds (\[QCT\] Appendix A), both until nothing
//!    changes, with no host round trip but a look at a counter every few rounds.
//!
//! Departures: entries of the stacks carry the first pixel that they win, which is exact in integers, so that ties go by
//! the total order of [`Key`](crate::Key) in every step, and the last step is a search and not a walk. Lists of debris are
//! appended to in the order of arrival; what is handed on comes out of a compaction, ascending.

mod bounds;
mod buffers;
mod record;

pub use bounds::{BoundsRead, FindBounds};
pub use buffers::{Buffers, CountsRead};

use crate::kernels::*;
use polder_vulkan::{Device, Error, Estimate, Kernel};

/// How long the bands of the coloring are. The result does not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bands {
    /// Rows of a band, at least 1.
    pub rows: u32,
    /// Columns of a band, between 1 and 255.
    pub columns: u32,
}

impl Default for Bands {
    fn default() -> Self {
        Self { rows: 64, columns: 64 }
    }
}

impl Bands {
    fn clamped(self) -> Self {
        Self { rows: self.rows.clamp(1, crate::MAX_SIDE), columns: self.columns.clamp(1, 255) }
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    bands: Bands,
    map_points: Kernel<MapPoints>,
    elect_sites: Kernel<ElectSites>,
    number_sites: Kernel<NumberSites>,
    missing_keys: Kernel<MissingKeys>,
    number_missing: Kernel<NumberMissing>,
    place_sites: Kernel<PlaceSites>,
    column_ends: Kernel<ColumnEnds>,
    column_fill: Kernel<ColumnFill>,
    row_stacks: Kernel<RowStacks>,
    row_merge: Kernel<RowMerge>,
    color_pixels: Kernel<ColorPixels>,
    mark_debris: Kernel<MarkDebris>,
    advance_round: Kernel<AdvanceRound>,
    drop_debris: Kernel<DropDebris>,
    check_debris: Kernel<CheckDebris>,
    find_color: Kernel<FindColor>,
    take_color: Kernel<TakeColor>,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_bands(device, Bands::default())
    }

    /// With bands of another length: for measurements and tests.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn with_bands(device: &Device, bands: Bands) -> Result<Self, Error> {
        Ok(Self {
            device: device.clone(),
            bands: bands.clamped(),
            map_points: Kernel::new(device, &[])?,
            elect_sites: Kernel::new(device, &[])?,
            number_sites: Kernel::new(device, &[])?,
            missing_keys: Kernel::new(device, &[])?,
            number_missing: Kernel::new(device, &[])?,
            place_sites: Kernel::new(device, &[])?,
            column_ends: Kernel::new(device, &[])?,
            column_fill: Kernel::new(device, &[])?,
            row_stacks: Kernel::new(device, &[])?,
            row_merge: Kernel::new(device, &[])?,
            color_pixels: Kernel::new(device, &[])?,
            mark_debris: Kernel::new(device, &[])?,
            advance_round: Kernel::new(device, &[])?,
            drop_debris: Kernel::new(device, &[])?,
            check_debris: Kernel::new(device, &[])?,
            find_color: Kernel::new(device, &[])?,
            take_color: Kernel::new(device, &[])?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(&self, points: usize, size: [u32; 2]) -> Estimate {
        buffers::estimate(&self.device, points, size, self.bands)
    }

    /// Memory for so many points, at least one, and a grid of this size.
    ///
    /// # Errors
    ///
    /// If the numbers are impossible, or the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, points: usize, size: [u32; 2]) -> Result<Buffers, Error> {
        Buffers::new(&self.device, points, size, self.bands)
    }
}
