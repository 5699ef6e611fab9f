//! Uploads and downloads through memory that both sides reach.
//!
//! One thread copies a fifth of what the bus carries, so the host's part is done by all threads of rayon's pool, in
//! pieces, and in turns on two staging buffers: while the device works on one, the host works on the other. Staging
//! memory is dear to make and is kept.

use crate::Error;
use crate::buffer::View;
use crate::engine::Engine;
use crate::memory::Allocated;
use crate::run::host_reads;
use crate::submit::{Slot, Used};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Duration;

/// Bytes that go at once.
const CHUNK: u64 = 32 << 20;
/// Bytes that one task of the pool copies.
const PIECE: usize = 1 << 20;
const TIMEOUT: Duration = Duration::from_secs(60);

/// Two buffers each way, made when first needed.
#[derive(Default)]
pub(crate) struct Staging {
    up: [Option<Allocated>; 2],
    down: [Option<Allocated>; 2],
}

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Up,
    Down,
}

/// A chunk on its way.
struct Flight {
    slot: Slot,
    value: u64,
    half: usize,
    start: usize,
    bytes: usize,
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

fn copy(to: &mut [u8], from: &[u8]) {
    if from.len() <= 2 * PIECE {
        return to.copy_from_slice(from);
    }
    to.par_chunks_mut(PIECE).zip(from.par_chunks(PIECE)).for_each(|(to, from)| to.copy_from_slice(from));
}

impl Engine {
    /// Brings elements to the first of a view and waits until they are there.
    pub fn upload<T: Pod>(&mut self, to: View<'_, T>, data: &[T]) -> Result<(), Error> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.fits("upload", to, data.len())?;
        let mut flights: [Option<Flight>; 2] = [None, None];
        let done = self.up(to, bytes, &mut flights);
        self.land(Way::Up, to, flights, done, |_, _| {})
    }

    fn up<T: Pod>(&mut self, to: View<'_, T>, bytes: &[u8], flights: &mut [Option<Flight>; 2]) -> Result<(), Error> {
        for (index, chunk) in bytes.chunks(CHUNK as usize).enumerate() {
            let half = index % 2;
            if let Some(flight) = &flights[half] {
                self.submitter.wait(flight.value, TIMEOUT)?;
            }
            if let Some(flight) = flights[half].take() {
                self.submitter.done(flight.slot);
            }
            self.stage(Way::Up, half, chunk.len() as u64)?;
            let staged = self.staging.up[half].as_mut().and_then(Allocated::mapped_mut);
            let staged = staged.and_then(|staged| staged.get_mut(..chunk.len())).ok_or_else(unmapped)?;
            copy(staged, chunk);
            flights[half] = Some(self.fly(Way::Up, half, to, index * CHUNK as usize, chunk.len())?);
        }
        Ok(())
    }

    /// Fetches elements from the first of a view on.
    pub fn download<T: Pod>(&mut self, from: View<'_, T>, into: &mut [T]) -> Result<(), Error> {
        self.fits("download", from, into.len())?;
        let into: &mut [u8] = bytemuck::cast_slice_mut(into);
        let mut flights: [Option<Flight>; 2] = [None, None];
        let mut done = Ok(());
        for (index, start) in (0..into.len()).step_by(CHUNK as usize).enumerate() {
            let bytes = (into.len() - start).min(CHUNK as usize);
            done = self.down(from, index % 2, start, bytes, &mut flights, into);
            if done.is_err() {
                break;
            }
        }
        // The older one first.
        let order = [flights[0].take(), flights[1].take()];
        self.land(Way::Down, from, order, done, |staged, flight| {
            copy(&mut into[flight.start..flight.start + flight.bytes], &staged[..flight.bytes]);
        })
    }

    fn down<T: Pod>(
        &mut self,
        from: View<'_, T>,
        half: usize,
        start: usize,
        bytes: usize,
        flights: &mut [Option<Flight>; 2],
        into: &mut [u8],
    ) -> Result<(), Error> {
        if let Some(flight) = &flights[half] {
            self.submitter.wait(flight.value, TIMEOUT)?;
            let staged = self.staging.down[half].as_ref().and_then(Allocated::mapped).ok_or_else(unmapped)?;
            copy(&mut into[flight.start..flight.start + flight.bytes], &staged[..flight.bytes]);
        }
        if let Some(flight) = flights[half].take() {
            self.submitter.done(flight.slot);
        }
        self.stage(Way::Down, half, bytes as u64)?;
        flights[half] = Some(self.fly(Way::Down, half, from, start, bytes)?);
        Ok(())
    }

    /// All elements of a view.
    pub fn download_vec<T: Pod>(&mut self, from: View<'_, T>) -> Result<Vec<T>, Error> {
        let mut data = vec![T::zeroed(); from.len()];
        self.download(from, &mut data)?;
        Ok(data)
    }

    fn fits<T: Pod>(&self, command: &'static str, view: View<'_, T>, len: usize) -> Result<(), Error> {
        if !Arc::ptr_eq(&view.buffer.device, &self.submitter.device) {
            return Err(Error::Recording { command, why: "the buffer is of another device".to_owned() });
        }
        if len > view.len() {
            return Err(Error::Recording { command, why: format!("{len} elements for a view of {}", view.len()) });
        }
        self.submitter.device.alive()
    }

    fn stage(&mut self, way: Way, half: usize, bytes: u64) -> Result<(), Error> {
        let (place, name, usage, location) = match way {
            Way::Up => {
                (&mut self.staging.up[half], "upload", vk::BufferUsageFlags::TRANSFER_SRC, MemoryLocation::CpuToGpu)
            }
            Way::Down => {
                (&mut self.staging.down[half], "download", vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu)
            }
        };
        if place.as_ref().is_none_or(|buffer| buffer.bytes < bytes) {
            let bytes = bytes.next_power_of_two().clamp(1 << 16, CHUNK);
            *place = None;
            *place = Some(Allocated::new(&self.submitter.device, name, bytes, usage, location)?);
        }
        Ok(())
    }

    /// Sends one chunk on its way between a half of the staging memory and byte `start` of the view.
    fn fly<T: Pod>(
        &mut self,
        way: Way,
        half: usize,
        view: View<'_, T>,
        start: usize,
        bytes: usize,
    ) -> Result<Flight, Error> {
        let place = match way {
            Way::Up => &self.staging.up[half],
            Way::Down => &self.staging.down[half],
        };
        let staged = place.as_ref().map(|staged| staged.buffer).ok_or_else(unmapped)?;
        let (buffer, at) = (view.buffer.memory.buffer, view.start + start as u64);
        let slot = self.submitter.begin()?;
        let region = vk::BufferCopy::default().size(bytes as u64);
        let raw = &self.submitter.device.raw;
        // SAFETY: the command buffer is being recorded; the range lies in the view and in the staging buffer, and both
        // are kept until the device is done (see `land`).
        unsafe {
            match way {
                Way::Up => raw.cmd_copy_buffer(slot.commands, staged, buffer, &[region.dst_offset(at)]),
                Way::Down => {
                    raw.cmd_copy_buffer(slot.commands, buffer, staged, &[region.src_offset(at)]);
                    host_reads(raw, slot.commands);
                }
            }
        }
        match self.submitter.submit(&slot) {
            Ok(value) => Ok(Flight { slot, value, half, start, bytes }),
            Err(error) => {
                self.submitter.done(slot);
                Err(error)
            }
        }
    }

    /// Waits for what is still on its way; what does not come in time is parked with its memory.
    fn land<T: Pod>(
        &mut self,
        way: Way,
        view: View<'_, T>,
        flights: [Option<Flight>; 2],
        mut done: Result<(), Error>,
        mut arrived: impl FnMut(&[u8], &Flight),
    ) -> Result<(), Error> {
        for flight in flights.into_iter().flatten() {
            let landed = self.submitter.wait(flight.value, TIMEOUT);
            let place = match way {
                Way::Up => &mut self.staging.up[flight.half],
                Way::Down => &mut self.staging.down[flight.half],
            };
            match landed {
                Ok(()) => {
                    if let Some(staged) = place.as_ref().and_then(Allocated::mapped) {
                        arrived(staged, &flight);
                    }
                    self.submitter.done(flight.slot);
                }
                Err(error) => {
                    let staging = place.take().into_iter().collect();
                    let used = Used { buffers: vec![Arc::clone(view.buffer)], staging, ..Used::default() };
                    self.submitter.park(flight.slot, flight.value, used);
                    done = done.and(Err(error));
                }
            }
        }
        done
    }
}

fn unmapped() -> Error {
    Error::Vulkan { call: "vkMapMemory", result: vk::Result::ERROR_MEMORY_MAP_FAILED }
}
