//! Device memory: who holds how much, the cap, and estimates before anything is allocated.

use crate::Error;
use crate::device::{Device, DeviceInner};
use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator};
use gpu_allocator::{AllocationError, MemoryLocation};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of a guard zone, and what is in it.
const GUARD: u64 = 16 << 10;
const PATTERN: u8 = 0xa5;

pub(crate) struct Memory {
    /// Until the device goes: the allocator frees its blocks before that.
    allocator: Option<Arc<Mutex<Allocator>>>,
    cap: Option<u64>,
    used: AtomicU64,
    peak: AtomicU64,
    /// The largest piece that the driver gave.
    given: AtomicU64,
    /// Whether buffers stand between guard zones.
    guarded: bool,
    /// Writes into guard zones of buffers that are gone.
    overruns: Mutex<Vec<String>>,
}

/// Bytes of device memory that buffers of one device hold, staging included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MemoryUse {
    /// Bytes now.
    pub used: u64,
    /// The most there ever were.
    pub peak: u64,
}

impl Memory {
    pub(crate) fn new(allocator: Arc<Mutex<Allocator>>, cap: Option<u64>, guarded: bool) -> Self {
        Memory {
            allocator: Some(allocator),
            cap,
            used: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            given: AtomicU64::new(0),
            guarded,
            overruns: Mutex::default(),
        }
    }

    pub(crate) fn release(&mut self) {
        self.allocator = None;
    }

    fn with_allocator<R>(&self, work: impl FnOnce(&mut Allocator) -> R) -> Option<R> {
        let allocator = self.allocator.as_ref()?;
        Some(work(&mut allocator.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Writes into guard zones of buffers that are gone.
    pub(crate) fn overruns(&self) -> Vec<String> {
        self.overruns.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn usage(&self) -> MemoryUse {
        MemoryUse { used: self.used.load(Ordering::Relaxed), peak: self.peak.load(Ordering::Relaxed) }
    }
}

/// A Vulkan buffer with its memory.
pub(crate) struct Allocated {
    pub(crate) buffer: vk::Buffer,
    pub(crate) bytes: u64,
    /// Bytes before the first that is meant for use, and behind the last.
    pub(crate) guard: u64,
    name: &'static str,
    pub(crate) allocation: Option<Allocation>,
    device: Arc<DeviceInner>,
}

impl Allocated {
    /// Allocates at least `bytes`, rounded up to a multiple of 16 so that kernels may read by fours.
    pub(crate) fn new(
        device: &Arc<DeviceInner>,
        name: &'static str,
        bytes: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Self, Error> {
        let memory = &device.memory;
        let bytes = bytes.max(16).checked_next_multiple_of(16).unwrap_or(u64::MAX);
        let used = memory.used.load(Ordering::Relaxed);
        let refused = || Error::OutOfMemory { what: name.to_owned(), bytes, used };
        let limits = &device.info.limits;
        if bytes > limits.buffer_bytes {
            return Err(too_large(name, bytes, limits.buffer_bytes));
        }
        if device.faults.allocation_fails() || memory.cap.is_some_and(|cap| used.saturating_add(bytes) > cap) {
            return Err(refused());
        }
        // Guard zones are looked at by the host.
        let guarded = memory.guarded && location == MemoryLocation::GpuOnly;
        let (guard, location) = if guarded { (GUARD, MemoryLocation::CpuToGpu) } else { (0, location) };
        let size = bytes + 2 * guard;
        let info = vk::BufferCreateInfo::default().size(size).usage(usage).sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is alive, the description valid: its size is not zero and within the limit.
        let buffer = unsafe { device.raw.create_buffer(&info, None) }.map_err(|_| refused())?;
        // SAFETY: the buffer was made from this device.
        let requirements = unsafe { device.raw.get_buffer_memory_requirements(buffer) };
        // Larger ones some drivers give all the same.
        let promised = requirements.size <= limits.allocation_bytes;
        let mut made = Allocated { buffer, bytes, guard, name, allocation: None, device: Arc::clone(device) };
        let description = AllocationCreateDesc {
            name,
            requirements,
            location,
            linear: true,
            allocation_scheme: match promised {
                true => AllocationScheme::GpuAllocatorManaged,
                false => AllocationScheme::DedicatedBuffer(buffer),
            },
        };
        let allocation = memory.with_allocator(|allocator| allocator.allocate(&description)).ok_or_else(refused)?;
        let allocation = allocation.map_err(|error| match error {
            AllocationError::OutOfMemory if !promised => too_large(name, bytes, limits.allocation_bytes),
            AllocationError::OutOfMemory => refused(),
            other => Error::OutOfMemory { what: format!("{name} ({other})"), bytes, used },
        })?;
        // SAFETY: the memory was allocated for this buffer's requirements and belongs to nothing else.
        let bound = unsafe { device.raw.bind_buffer_memory(buffer, allocation.memory(), allocation.offset()) };
        made.allocation = Some(allocation);
        let now = memory.used.fetch_add(bytes, Ordering::Relaxed) + bytes;
        memory.peak.fetch_max(now, Ordering::Relaxed);
        bound.map_err(|_| refused())?;
        for zone in made.zones() {
            let mapped = made.allocation.as_mut().and_then(Allocation::mapped_slice_mut);
            if let Some(zone) = mapped.and_then(|mapped| mapped.get_mut(zone)) {
                zone.fill(PATTERN);
            }
        }
        Ok(made)
    }

    /// The guard zones: before the first byte, and behind the last.
    fn zones(&self) -> [Range<usize>; 2] {
        let (guard, bytes) = (self.guard as usize, self.bytes as usize);
        [0..guard, guard + bytes..2 * guard + bytes]
    }

    /// What was written into a guard zone, in words.
    pub(crate) fn overrun(&self) -> Option<String> {
        let mapped = self.allocation.as_ref()?.mapped_slice()?;
        // Copied first: reading memory of a GPU byte by byte takes a microsecond each.
        let [before, behind] = self.zones().map(|zone| mapped.get(zone).unwrap_or_default().to_vec());
        let written = |byte: &u8| *byte != PATTERN;
        let (name, bytes) = (self.name, self.bytes);
        if let Some(place) = behind.iter().position(written) {
            return Some(format!("buffer `{name}` of {bytes} bytes: written {place} bytes behind its end"));
        }
        let place = before.len() - before.iter().rposition(written)?;
        Some(format!("buffer `{name}` of {bytes} bytes: written {place} bytes before its start"))
    }
}

impl Drop for Allocated {
    fn drop(&mut self) {
        if let Some(overrun) = self.overrun().filter(|_| self.guard > 0) {
            self.device.memory.overruns.lock().unwrap_or_else(PoisonError::into_inner).push(overrun);
        }
        // SAFETY: made from this device; recordings and engines hold what is in flight alive, so it is in no use.
        unsafe { self.device.raw.destroy_buffer(self.buffer, None) };
        if let Some(allocation) = self.allocation.take() {
            let memory = &self.device.memory;
            memory.used.fetch_sub(self.bytes, Ordering::Relaxed);
            // Freeing fails only for an allocation of another allocator.
            let _ = memory.with_allocator(|allocator| allocator.free(allocation));
        }
    }
}

/// What a piece of work will hold at once, asked before any of it is allocated.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Estimate {
    buffers: Vec<(&'static str, u64)>,
}

impl Estimate {
    /// Nothing yet.
    pub fn new() -> Self {
        Estimate::default()
    }

    /// With one more buffer.
    #[must_use]
    pub fn buffer<T>(mut self, name: &'static str, len: usize) -> Self {
        let bytes = (len as u64).saturating_mul(size_of::<T>() as u64);
        self.buffers.push((name, bytes.max(16).checked_next_multiple_of(16).unwrap_or(u64::MAX)));
        self
    }

    /// With all buffers of another estimate.
    #[must_use]
    pub fn and(mut self, other: Estimate) -> Self {
        self.buffers.extend(other.buffers);
        self
    }

    /// Bytes in all.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().fold(0, |sum: u64, (_, bytes)| sum.saturating_add(*bytes))
    }

    /// [`Error::TooLarge`] where a buffer passes a limit of the device, or all together the memory that is left.
    ///
    /// A buffer larger than the driver promises to allocate (4 GiB on many) is asked for, and given back at once: some
    /// give more than they promise.
    pub fn check(&self, device: &Device) -> Result<(), Error> {
        let limits = device.info().limits;
        let largest = self.buffers.iter().max_by_key(|(_, bytes)| *bytes).copied();
        if let Some((name, bytes)) = largest.filter(|(_, bytes)| *bytes > limits.buffer_bytes) {
            return Err(too_large(name, bytes, limits.buffer_bytes));
        }
        let available = device.available_memory();
        if self.bytes() > available {
            let (name, _) = largest.unwrap_or_default();
            let what = format!("all buffers; the largest is `{name}`");
            return Err(Error::TooLarge { needed: self.bytes(), available, what });
        }
        match largest {
            Some((name, bytes)) if bytes > limits.allocation_bytes && !device.inner.gives(bytes) => {
                Err(too_large(name, bytes, limits.allocation_bytes))
            }
            _ => Ok(()),
        }
    }
}

fn too_large(name: &str, needed: u64, available: u64) -> Error {
    Error::TooLarge { needed, available, what: format!("one buffer, `{name}`") }
}

impl DeviceInner {
    /// Whether the driver gives so much in one piece: tried, unless it gave as much before.
    fn gives(&self, bytes: u64) -> bool {
        let given = &self.memory.given;
        if bytes <= given.load(Ordering::Relaxed) {
            return true;
        }
        // SAFETY: the physical device is of this instance.
        let all = unsafe { self.instance.inner.raw.get_physical_device_memory_properties(self.info.physical) };
        let local = all.memory_types_as_slice().iter();
        let local =
            local.zip(0..).find(|(kind, _)| kind.property_flags.contains(vk::MemoryPropertyFlags::DEVICE_LOCAL));
        let Some((_, kind)) = local else { return false };
        let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
        let wanted =
            vk::MemoryAllocateInfo::default().allocation_size(bytes).memory_type_index(kind).push_next(&mut flags);
        // SAFETY: the device is alive and has this kind of memory.
        let Ok(memory) = (unsafe { self.raw.allocate_memory(&wanted, None) }) else { return false };
        // SAFETY: allocated a moment ago, and bound to nothing.
        unsafe { self.raw.free_memory(memory, None) };
        given.fetch_max(bytes, Ordering::Relaxed);
        true
    }

    /// Bytes that may still be allocated: what the driver would give, within the cap.
    pub(crate) fn available_memory(&self) -> u64 {
        let used = self.memory.usage().used;
        let mut left = self.info.memory_bytes.saturating_sub(used);
        if self.info.memory_budget {
            let mut budget = vk::PhysicalDeviceMemoryBudgetPropertiesEXT::default();
            let mut all = vk::PhysicalDeviceMemoryProperties2::default().push_next(&mut budget);
            // SAFETY: the physical device is of this instance and knows the budget's extension.
            unsafe { self.instance.inner.raw.get_physical_device_memory_properties2(self.info.physical, &mut all) };
            let heaps = all.memory_properties;
            let local = (0..heaps.memory_heap_count as usize)
                .filter(|heap| heaps.memory_heaps[*heap].flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
            let free = local.map(|heap| budget.heap_budget[heap].saturating_sub(budget.heap_usage[heap])).max();
            left = left.min(free.unwrap_or(u64::MAX));
        }
        match self.memory.cap {
            Some(cap) => left.min(cap.saturating_sub(used)),
            None => left,
        }
    }
}
