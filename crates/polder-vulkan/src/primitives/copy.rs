//! Copies on the device.

use crate::Error;
use crate::buffer::View;
use crate::device::Device;
use crate::kernel::Kernel;
use crate::kernels::{CopyWords, CopyWordsArgs};
use crate::recording::{Recording, groups_for};
use bytemuck::Pod;

const EACH: u32 = 16;
const MOST_WORDS: usize = 1 << 30;

/// Copies by a kernel: as fast as memory, where the driver's command can take five times as long.
#[derive(Debug)]
pub struct Copier {
    kernel: Kernel<CopyWords>,
}

impl Copier {
    /// Holds no memory.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Copier { kernel: Kernel::new(device, &[])? })
    }

    /// Copies all elements to the first of `to`, which may not overlap them. Their size must be a multiple of 4 bytes.
    pub fn record<T: Pod>(&self, recording: &mut Recording, from: View<'_, T>, to: View<'_, T>) {
        let bytes = from.bytes();
        let apart = to.start + bytes <= from.start || from.start + bytes <= to.start;
        let same = from.buffer.id == to.buffer.id;
        if !size_of::<T>().is_multiple_of(4) || from.len() > to.len() || (same && !apart) {
            return recording.fail("copy", format!("{from:?} to {to:?}"));
        }
        let (from, to) = (from.cast::<u32>(), to.cast::<u32>());
        for first in (0..from.len()).step_by(MOST_WORDS) {
            let range = first..from.len().min(first + MOST_WORDS);
            let count = range.len() as u32;
            // `first` is a multiple of 16 bytes: both slices exist.
            if let (Ok(from), Ok(to)) = (from.slice(range.clone()), to.slice(range)) {
                let groups = groups_for(count as usize, EACH * self.kernel.workgroup()[0]);
                recording.dispatch(&self.kernel, groups, &CopyWordsArgs { from, to, count });
            }
        }
    }
}
