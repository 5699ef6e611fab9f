//! Stream compaction.

use super::scan::{SumsScan, TILE, WORKGROUP, stay_raw};
use super::{Count, MOST, holds};
use crate::Error;
use crate::buffer::{Buffer, View};
use crate::device::Device;
use crate::kernel::Kernel;
use crate::kernels::{CompactCount, CompactCountArgs, CompactWrite, CompactWriteArgs};
use crate::memory::Estimate;
use crate::recording::{Recording, groups_for};

const NAME: &str = "compact";

/// What is flagged, in order. Reads the flags twice.
#[derive(Debug)]
pub struct Compact {
    count: Kernel<CompactCount>,
    sums_scan: SumsScan,
    write: Kernel<CompactWrite>,
    raw_write: Kernel<CompactWrite>,
    sums: Buffer<u32>,
    capacity: usize,
}

impl Compact {
    /// What a compaction of so many flags holds.
    pub fn estimate(capacity: usize) -> Estimate {
        Estimate::new().buffer::<u32>("flags in tiles", capacity.div_ceil(TILE as usize))
    }

    /// For up to `capacity` flags, at most [`MOST`].
    pub fn new(device: &Device, capacity: usize) -> Result<Self, Error> {
        let capacity = capacity.min(MOST);
        Ok(Compact {
            count: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            sums_scan: SumsScan::new(device)?,
            write: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            raw_write: Kernel::new(device, &[("WORKGROUP", WORKGROUP), ("RAW", 1)])?,
            sums: Buffer::new(device, "flags in tiles", capacity.div_ceil(TILE as usize))?,
            capacity,
        })
    }

    /// Writes to `kept` the values (without values: the indices) whose flag is not zero, in order, and to the first word
    /// of `total` how many there are. `kept` must have room for all of `count`; what lies behind the kept ones stays.
    pub fn record<'a>(
        &self,
        recording: &mut Recording,
        count: impl Into<Count<'a>>,
        flags: View<'_, u32>,
        values: Option<View<'_, u32>>,
        kept: View<'_, u32>,
        total: View<'_, u32>,
    ) {
        let count = count.into();
        let limit = count.limit;
        if !count.fits(recording, NAME, self.capacity)
            || !holds(recording, NAME, flags, limit)
            || values.is_some_and(|values| !holds(recording, NAME, values, limit))
            || !holds(recording, NAME, kept, limit)
            || !holds(recording, NAME, total, 1)
        {
            return;
        }
        let groups = groups_for(limit, TILE);
        let (counter, sums) = (count.counter, self.sums.view());
        let arguments = CompactCountArgs { words: flags, sums, counter, limit: count.limit() };
        recording.dispatch(&self.count, groups, &arguments);
        let raw = stay_raw(limit);
        if !raw {
            self.sums_scan.record(recording, count, sums, Some(total));
        }
        let (write, total) = if raw { (&self.raw_write, Some(total)) } else { (&self.write, None) };
        let arguments = CompactWriteArgs { flags, values, kept, sums, total, counter, limit: count.limit() };
        recording.dispatch(write, groups, &arguments);
    }
}
