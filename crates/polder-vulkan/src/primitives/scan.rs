//! Exclusive scan of u32.

use super::{Count, MOST, holds};
use crate::Error;
use crate::buffer::{Buffer, View};
use crate::device::Device;
use crate::kernel::Kernel;
use crate::kernels::{ScanReduce, ScanReduceArgs, ScanSums, ScanSumsArgs, ScanTiles, ScanTilesArgs};
use crate::memory::Estimate;
use crate::recording::{Recording, groups_for};

/// Words that an invocation takes; as in `tile.glsl`.
const EACH: u32 = 16;
pub(super) const WORKGROUP: u32 = 256;
pub(super) const TILE: u32 = EACH * WORKGROUP;
const NAME: &str = "scan";

/// Up to so many tiles, each adds up the sums of those before it, which is faster than a kernel between. Beyond, it is not:
/// the work goes with the square.
const FEW_TILES: usize = 4096;

/// Whether the sums of so many words stay as they are.
pub(super) fn stay_raw(limit: usize) -> bool {
    (1..=FEW_TILES * TILE as usize).contains(&limit)
}

/// The kernel between the two that walk the tiles: scans their sums. Compaction and sort share it.
#[derive(Debug)]
pub(super) struct SumsScan {
    kernel: Kernel<ScanSums>,
}

impl SumsScan {
    pub(super) fn new(device: &Device) -> Result<Self, Error> {
        let lanes = device.info().limits.subgroup;
        let workgroup = device.info().limits.workgroup_invocations.min(1024) / lanes * lanes;
        Ok(SumsScan { kernel: Kernel::new(device, &[("WORKGROUP", workgroup)])? })
    }

    pub(super) fn record(
        &self,
        recording: &mut Recording,
        count: Count<'_>,
        sums: View<'_, u32>,
        total: Option<View<'_, u32>>,
    ) {
        let arguments = ScanSumsArgs { sums, total, counter: count.counter, limit: count.limit(), tile: TILE };
        recording.dispatch(&self.kernel, [1, 1, 1], &arguments);
    }
}

/// The sums before each word. Reads the input twice, writes once.
#[derive(Debug)]
pub struct Scan {
    reduce: Kernel<ScanReduce>,
    sums_scan: SumsScan,
    tiles: Kernel<ScanTiles>,
    raw_tiles: Kernel<ScanTiles>,
    sums: Buffer<u32>,
    capacity: usize,
}

impl Scan {
    /// What a scan of so many words holds.
    pub fn estimate(capacity: usize) -> Estimate {
        Estimate::new().buffer::<u32>("sums of tiles", capacity.div_ceil(TILE as usize))
    }

    /// For up to `capacity` words, at most [`MOST`].
    pub fn new(device: &Device, capacity: usize) -> Result<Self, Error> {
        let capacity = capacity.min(MOST);
        Ok(Scan {
            reduce: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            sums_scan: SumsScan::new(device)?,
            tiles: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            raw_tiles: Kernel::new(device, &[("WORKGROUP", WORKGROUP), ("RAW", 1)])?,
            sums: Buffer::new(device, "sums of tiles", capacity.div_ceil(TILE as usize))?,
            capacity,
        })
    }

    /// Writes to each word of `scanned` the sum of all words before it, and to the first of `total` the sum of all. Sums
    /// wrap around. `scanned` may be `words`.
    pub fn record<'a>(
        &self,
        recording: &mut Recording,
        count: impl Into<Count<'a>>,
        words: View<'_, u32>,
        scanned: View<'_, u32>,
        total: Option<View<'_, u32>>,
    ) {
        let count = count.into();
        let limit = count.limit;
        if !count.fits(recording, NAME, self.capacity)
            || !holds(recording, NAME, words, limit)
            || !holds(recording, NAME, scanned, limit)
            || total.is_some_and(|total| !holds(recording, NAME, total, 1))
        {
            return;
        }
        let groups = groups_for(limit, TILE);
        let (counter, sums) = (count.counter, self.sums.view());
        let arguments = ScanReduceArgs { words, sums, counter, limit: count.limit() };
        recording.dispatch(&self.reduce, groups, &arguments);
        let raw = stay_raw(limit);
        if !raw {
            self.sums_scan.record(recording, count, sums, total);
        }
        let (tiles, total) = if raw { (&self.raw_tiles, total) } else { (&self.tiles, None) };
        let arguments = ScanTilesArgs { words, scanned, sums, total, counter, limit: count.limit() };
        recording.dispatch(tiles, groups, &arguments);
    }
}
