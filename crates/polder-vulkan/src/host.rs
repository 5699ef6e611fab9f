//! Memory of the host that downloads fill.
//!
//! Fresh memory has no pages until it is written to, and making them costs more than bringing the bytes from the device.
//! So all threads make them, huge ones where the system has them, and may do so before there is anything to bring.

use bytemuck::Pod;
use rayon::prelude::*;
use std::mem::MaybeUninit;

/// Bytes of a huge page, and of a small one; where they are larger, more is touched than need be.
const HUGE: usize = 2 << 20;
const PAGE: usize = 4 << 10;
/// Memory below this comes from the allocator's own, or has its pages soon enough.
const LEAST: usize = 4 * HUGE;

/// An empty vector with room for `len` elements in memory whose pages are there, made by all threads of rayon's pool.
///
/// To be called while a device works, so that [`Engine::fetch`](crate::Engine::fetch) need not wait for the memory.
pub fn room_for<T: Pod>(len: usize) -> Vec<T> {
    let mut room = Vec::with_capacity(len);
    let bytes = bytes_of(room.spare_capacity_mut());
    if bytes.len() >= LEAST {
        ask_for_huge_pages(bytes);
        let (head, huge) = bytes.split_at_mut(bytes.as_ptr().align_offset(HUGE).min(bytes.len()));
        huge.par_chunks_mut(HUGE).chain(head.par_chunks_mut(HUGE)).for_each(touch);
    }
    room
}

fn touch(bytes: &mut [MaybeUninit<u8>]) {
    bytes.iter_mut().step_by(PAGE).for_each(|byte| _ = byte.write(0));
}

/// The same memory as bytes.
pub(crate) fn bytes_of<T: Pod>(room: &mut [MaybeUninit<T>]) -> &mut [MaybeUninit<u8>] {
    // SAFETY: the same memory for the same time; bytes that need not be initialized have no requirements.
    unsafe { std::slice::from_raw_parts_mut(room.as_mut_ptr().cast(), size_of_val(room)) }
}

#[cfg(target_os = "linux")]
fn ask_for_huge_pages(bytes: &mut [MaybeUninit<u8>]) {
    let whole = bytes.get_mut(bytes.as_ptr().align_offset(HUGE)..).unwrap_or_default();
    let len = whole.len() / HUGE * HUGE;
    // SAFETY: the range is borrowed, and begins at a page. The advice changes what pages it gets, not what it holds. A
    // kernel that does not take it says so, and all is as it was.
    unsafe { libc::madvise(whole.as_mut_ptr().cast(), len, libc::MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn ask_for_huge_pages(_: &mut [MaybeUninit<u8>]) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_as_large_as_wanted() {
        for len in [0, 1, LEAST / 12, LEAST / 12 + 1, 1_000_003] {
            let room = room_for::<[u32; 3]>(len);
            assert!(room.is_empty() && room.capacity() >= len);
        }
    }
}
