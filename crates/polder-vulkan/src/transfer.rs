//! Uploads and downloads through memory that both sides reach.
//!
//! One thread copies a fifth of what the bus carries, so the host's part is done by all threads of rayon's pool, in
//! pieces, and in turns on some staging buffers: while the device works on one, the host works on another. Staging
//! memory is dear to make and is kept.

use crate::Error;
use crate::buffer::{BufferInner, View};
use crate::engine::Engine;
use crate::host::{bytes_of, room_for};
use crate::memory::Allocated;
use crate::run::host_reads;
use crate::submit::{Slot, Used};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::mem::MaybeUninit;
use std::sync::Arc;
use std::time::Duration;

/// The most and the least bytes that go at once; between them, an eighth of all that go.
const MOST: usize = 16 << 20;
const LEAST: usize = 1 << 20;
/// So many chunks are on their way at once.
const AHEAD: usize = 4;
/// Bytes that one task of the pool copies.
const PIECE: usize = 256 << 10;
const TIMEOUT: Duration = Duration::from_secs(60);

/// Buffers for each way, made when first needed.
#[derive(Default)]
pub(crate) struct Staging {
    up: [Option<Allocated>; AHEAD],
    down: [Option<Allocated>; AHEAD],
}

/// Bytes of the host that come from the device, or go there.
enum Host<'a> {
    From(&'a [u8]),
    Into(&'a mut [MaybeUninit<u8>]),
}

/// What goes at once: bytes of the host, and where they are on the device.
struct Chunk<'a> {
    host: Host<'a>,
    buffer: Arc<BufferInner>,
    at: u64,
}

/// A chunk on its way.
struct Flight<'a> {
    slot: Slot,
    value: u64,
    place: usize,
    chunk: Chunk<'a>,
}

/// Several downloads that go as one: [`Engine::fetch`].
#[derive(Default)]
pub struct Downloads<'a> {
    parts: Vec<Part<'a>>,
}

struct Part<'a> {
    buffer: Arc<BufferInner>,
    start: u64,
    into: Box<dyn Into + 'a>,
}

/// A vector of any type that is being filled.
trait Into {
    fn room(&mut self) -> &mut [MaybeUninit<u8>];

    /// # Safety
    ///
    /// All of the room was written to.
    unsafe fn filled(&mut self);
}

struct Filling<'a, T> {
    vec: &'a mut Vec<T>,
    len: usize,
}

impl<T: Pod> Into for Filling<'_, T> {
    fn room(&mut self) -> &mut [MaybeUninit<u8>] {
        bytes_of(&mut self.vec.spare_capacity_mut()[..self.len])
    }

    unsafe fn filled(&mut self) {
        // SAFETY: the vector is empty, has room for so many, and they were written to, as the caller says.
        unsafe { self.vec.set_len(self.len) };
    }
}

impl std::fmt::Debug for Downloads<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Downloads({})", self.parts.len())
    }
}

impl<'a> Downloads<'a> {
    /// None yet.
    pub fn new() -> Self {
        Downloads::default()
    }

    /// One more: all elements of a view. What the vector holds is gone; its memory is used if there is room.
    #[must_use]
    pub fn and<T: Pod>(mut self, from: View<'_, T>, vec: &'a mut Vec<T>) -> Self {
        vec.clear();
        if vec.capacity() < from.len() {
            *vec = Vec::new();
            *vec = room_for(from.len());
        }
        let into = Box::new(Filling { vec, len: from.len() });
        self.parts.push(Part { buffer: Arc::clone(from.buffer), start: from.start, into });
        self
    }
}

impl Allocated {
    /// The bytes that the host sees.
    pub(crate) fn mapped(&self) -> Option<&[u8]> {
        self.allocation.as_ref()?.mapped_slice()
    }

    fn mapped_mut(&mut self) -> Option<&mut [u8]> {
        self.allocation.as_mut()?.mapped_slice_mut()
    }
}

fn copy(to: &mut [MaybeUninit<u8>], from: &[u8]) {
    if from.len() <= 2 * PIECE {
        to.write_copy_of_slice(from);
        return;
    }
    to.par_chunks_mut(PIECE).zip(from.par_chunks(PIECE)).for_each(|(to, from)| _ = to.write_copy_of_slice(from));
}

/// How many bytes go at once where so many go in all.
fn chunk_size(bytes: usize) -> usize {
    (bytes / 8).next_multiple_of(LEAST).clamp(LEAST, MOST)
}

impl Engine {
    /// Brings elements to the first of a view and waits until they are there.
    pub fn upload<T: Pod>(&mut self, to: View<'_, T>, data: &[T]) -> Result<(), Error> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.fits("upload", to.buffer, data.len(), to.len())?;
        let size = chunk_size(bytes.len());
        self.transfer(bytes.chunks(size).enumerate().map(|(index, bytes)| Chunk {
            host: Host::From(bytes),
            buffer: Arc::clone(to.buffer),
            at: to.start + (index * size) as u64,
        }))
    }

    /// Fetches elements from the first of a view on.
    pub fn download<T: Pod>(&mut self, from: View<'_, T>, into: &mut [T]) -> Result<(), Error> {
        self.fits("download", from.buffer, into.len(), from.len())?;
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(into);
        // SAFETY: the same memory for the same time, and `transfer` writes nothing to it that is not initialized.
        let bytes = unsafe { std::slice::from_raw_parts_mut(bytes.as_mut_ptr().cast(), bytes.len()) };
        let size = chunk_size(bytes.len());
        self.transfer(landing(bytes, from.buffer, from.start, size))
    }

    /// All elements of a view.
    pub fn download_vec<T: Pod>(&mut self, from: View<'_, T>) -> Result<Vec<T>, Error> {
        let mut vec = Vec::new();
        self.fetch(Downloads::new().and(from, &mut vec))?;
        Ok(vec)
    }

    /// Fetches all elements of some views into vectors, one behind the other without a break. After an error they are empty.
    pub fn fetch(&mut self, downloads: Downloads<'_>) -> Result<(), Error> {
        let mut parts = downloads.parts;
        for part in &parts {
            self.fits("download", &part.buffer, 0, 0)?;
        }
        let size = chunk_size(parts.iter_mut().map(|part| part.into.room().len()).sum());
        self.transfer(parts.iter_mut().flat_map(|part| landing(part.into.room(), &part.buffer, part.start, size)))?;
        for part in &mut parts {
            // SAFETY: the chunks above are all of its room, and all have arrived.
            unsafe { part.into.filled() };
        }
        Ok(())
    }

    fn fits(&self, command: &'static str, buffer: &BufferInner, len: usize, room: usize) -> Result<(), Error> {
        if !Arc::ptr_eq(&buffer.device, &self.submitter.device) {
            return Err(Error::Recording { command, why: "the buffer is of another device".to_owned() });
        }
        if len > room {
            return Err(Error::Recording { command, why: format!("{len} elements for a view of {room}") });
        }
        self.submitter.device.alive()
    }

    /// Sends chunks on their way, some at once, and waits until all have arrived.
    fn transfer<'a>(&mut self, chunks: impl Iterator<Item = Chunk<'a>>) -> Result<(), Error> {
        let mut flights = VecDeque::new();
        let mut done = Ok(());
        for (index, chunk) in chunks.enumerate() {
            if flights.len() == AHEAD {
                done = flights.pop_front().map_or(Ok(()), |flight| self.land(flight));
            }
            let flight = done.and_then(|()| self.fly(index % AHEAD, chunk));
            done = flight.map(|flight| flights.push_back(flight));
            if done.is_err() {
                break;
            }
        }
        for flight in flights {
            let landed = self.land(flight);
            done = done.and(landed);
        }
        done
    }

    fn staged(&mut self, host: &Host<'_>, place: usize) -> &mut Option<Allocated> {
        match host {
            Host::From(_) => &mut self.staging.up[place],
            Host::Into(_) => &mut self.staging.down[place],
        }
    }

    /// Sends one chunk on its way through one of the staging buffers, which nothing uses.
    fn fly<'a>(&mut self, place: usize, chunk: Chunk<'a>) -> Result<Flight<'a>, Error> {
        let (bytes, name, usage, location) = match &chunk.host {
            Host::From(from) => (from.len(), "upload", vk::BufferUsageFlags::TRANSFER_SRC, MemoryLocation::CpuToGpu),
            Host::Into(into) => (into.len(), "download", vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu),
        };
        let device = Arc::clone(&self.submitter.device);
        let staged = self.staged(&chunk.host, place);
        if staged.as_ref().is_none_or(|staged| staged.bytes < bytes as u64) {
            let bytes = bytes.next_power_of_two().clamp(1 << 16, MOST) as u64;
            *staged = None;
            *staged = Some(Allocated::new(&device, name, bytes, usage, location)?);
        }
        let staged = staged.as_mut().ok_or_else(unmapped)?;
        if let Host::From(from) = &chunk.host {
            let into = staged.mapped_mut().and_then(|mapped| mapped.get_mut(..bytes)).ok_or_else(unmapped)?;
            into.par_chunks_mut(PIECE).zip(from.par_chunks(PIECE)).for_each(|(to, from)| to.copy_from_slice(from));
        }
        let staged = staged.buffer;
        let slot = self.submitter.begin()?;
        let region = vk::BufferCopy::default().size(bytes as u64);
        // SAFETY: the command buffer is being recorded; the range lies in the view and in the staging buffer, and both
        // are kept until the device is done (see `land`).
        unsafe {
            let (raw, buffer) = (&device.raw, chunk.buffer.memory.buffer);
            match &chunk.host {
                Host::From(_) => raw.cmd_copy_buffer(slot.commands, staged, buffer, &[region.dst_offset(chunk.at)]),
                Host::Into(_) => {
                    raw.cmd_copy_buffer(slot.commands, buffer, staged, &[region.src_offset(chunk.at)]);
                    host_reads(raw, slot.commands);
                }
            }
        }
        match self.submitter.submit(&slot) {
            Ok(value) => Ok(Flight { slot, value, place, chunk }),
            Err(error) => {
                self.submitter.done(slot);
                Err(error)
            }
        }
    }

    /// Waits for a chunk; if it does not come in time it is parked with its memory.
    fn land(&mut self, flight: Flight<'_>) -> Result<(), Error> {
        let Flight { slot, value, place, chunk } = flight;
        if let Err(error) = self.submitter.wait(value, TIMEOUT) {
            let staging = self.staged(&chunk.host, place).take().into_iter().collect();
            self.submitter.park(slot, value, Used { buffers: vec![chunk.buffer], staging, ..Used::default() });
            return Err(error);
        }
        self.submitter.done(slot);
        if let Host::Into(into) = chunk.host {
            let staged = self.staging.down[place].as_ref().and_then(Allocated::mapped);
            copy(into, staged.and_then(|staged| staged.get(..into.len())).ok_or_else(unmapped)?);
        }
        Ok(())
    }
}

/// Where the bytes of a part of a buffer go, in chunks of some size.
fn landing<'a>(
    into: &'a mut [MaybeUninit<u8>],
    buffer: &'a Arc<BufferInner>,
    start: u64,
    size: usize,
) -> impl Iterator<Item = Chunk<'a>> {
    into.chunks_mut(size).enumerate().map(move |(index, bytes)| Chunk {
        host: Host::Into(bytes),
        buffer: Arc::clone(buffer),
        at: start + (index * size) as u64,
    })
}

fn unmapped() -> Error {
    Error::Vulkan { call: "vkMapMemory", result: vk::Result::ERROR_MEMORY_MAP_FAILED }
}
