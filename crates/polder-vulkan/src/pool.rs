//! Memory that one piece of work has done with, and another one behind it may have.

use crate::buffer::BufferInner;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Parts that begin at multiples of this.
const ALIGN: u64 = 256;
/// Shorter buffers are not worth it.
const LEAST: u64 = 4096;

struct Free {
    buffer: Arc<BufferInner>,
    start: u64,
    bytes: u64,
}

/// Memory given by [`Buffer::give`](crate::Buffer::give), which buffers made on a device that
/// [reuses](crate::Device::reusing) it take before any is allocated.
///
/// Whoever gives a buffer says that nothing recorded from now on needs what it holds. Commands that were recorded before
/// may still use it: they come first, and the engine orders them, since it is one range of one buffer to it.
#[derive(Clone, Default)]
pub struct Pool {
    free: Arc<Mutex<Vec<Free>>>,
}

impl std::fmt::Debug for Pool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Pool({} parts)", self.free().len())
    }
}

impl Pool {
    fn free(&self) -> MutexGuard<'_, Vec<Free>> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Forgets all that it has: it goes with the buffers that it is part of.
    pub fn clear(&self) {
        self.free().clear();
    }

    pub(crate) fn give(&self, buffer: &Arc<BufferInner>, start: u64, bytes: u64) {
        if bytes >= LEAST {
            self.free().push(Free { buffer: Arc::clone(buffer), start, bytes });
        }
    }

    /// The smallest part that holds so many bytes; what is left of it stays here.
    pub(crate) fn take(&self, bytes: u64) -> Option<(Arc<BufferInner>, u64)> {
        if bytes < LEAST {
            return None;
        }
        let mut free = self.free();
        let fitting = (0..free.len()).filter(|&i| free[i].bytes >= bytes);
        let best = fitting.min_by_key(|&i| (free[i].bytes, i))?;
        let found = free.swap_remove(best);
        let used = bytes.next_multiple_of(ALIGN);
        if found.bytes >= used + LEAST {
            free.push(Free { buffer: Arc::clone(&found.buffer), start: found.start + used, bytes: found.bytes - used });
        }
        Some((found.buffer, found.start))
    }
}
