//! Scan, compaction, reduction, sort, copy: what stages are made of.
//!
//! Each is made once for a capacity, which says how much it holds ([`Estimate`](crate::Estimate)), and then records any
//! length up to it. Making one costs no more than its scratch memory, as kernels are compiled once a device. A length is a
//! number that the host knows, or one that the device wrote ([`Count`]). All work in tiles that one workgroup takes, in two
//! kernels: sums of the tiles, and the tiles again; beyond 2^24 elements a scan of the sums stands between. No workgroup
//! waits for another, which Vulkan would not promise to end; decoupled look-back, which reads memory once less, does.

mod compact;
mod copy;
mod reduce;
mod scan;
mod sort;

pub use compact::Compact;
pub use copy::Copier;
pub use reduce::{Operation, Reduce, ReduceValue};
pub use scan::Scan;
pub use sort::{Sort, SortKey, SortShape};

use crate::buffer::View;
use crate::recording::Recording;
use bytemuck::Pod;

/// The most elements of a primitive, of 4 bytes each; half as many of 8 bytes. Kernels reach no further from an address.
pub const MOST: usize = 1 << 30;

/// How many elements.
#[derive(Debug, Clone, Copy)]
pub struct Count<'a> {
    pub(crate) counter: Option<View<'a, u32>>,
    pub(crate) limit: usize,
}

impl From<usize> for Count<'_> {
    fn from(limit: usize) -> Self {
        Count { counter: None, limit }
    }
}

impl<'a> Count<'a> {
    /// As many as the first word of `counter` says when it is read, and at most `limit`.
    pub fn on_device(counter: View<'a, u32>, limit: usize) -> Self {
        Count { counter: Some(counter), limit }
    }

    fn limit(&self) -> u32 {
        self.limit as u32
    }

    /// Whether the count fits; the recording fails where it does not.
    fn fits(&self, recording: &mut Recording, name: &'static str, capacity: usize) -> bool {
        let empty = self.counter.is_some_and(|counter| counter.is_empty());
        if empty {
            recording.fail(name, "the counter is empty".to_owned());
        }
        if self.limit > capacity {
            recording.fail(name, format!("{} elements; it was made for {capacity}", self.limit));
        }
        !empty && self.limit <= capacity
    }
}

/// Whether a view holds `len` elements; the recording fails where it does not.
fn holds<T: Pod>(recording: &mut Recording, name: &'static str, view: View<'_, T>, len: usize) -> bool {
    if view.len() < len {
        recording.fail(name, format!("{len} elements; {view:?} is too short"));
    }
    view.len() >= len
}
