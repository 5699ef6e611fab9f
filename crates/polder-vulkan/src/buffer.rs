//! Typed buffers and views of them.

use crate::Error;
use crate::device::{Device, DeviceInner};
use crate::memory::Allocated;
use crate::pool::Pool;
use crate::shader::Touch;
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Where a view may begin: the widest read of a kernel.
pub const VIEW_ALIGN: usize = 16;

pub(crate) struct BufferInner {
    pub(crate) name: &'static str,
    pub(crate) id: u64,
    pub(crate) address: u64,
    pub(crate) memory: Allocated,
    pub(crate) device: Arc<DeviceInner>,
}

/// Elements in device memory. What they hold at first is not defined.
///
/// A recording that uses a buffer keeps it alive.
pub struct Buffer<T> {
    inner: Arc<BufferInner>,
    start: u64,
    len: usize,
    of: PhantomData<fn() -> T>,
}

impl<T> std::fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Buffer({} x {} `{}`)", self.len, std::any::type_name::<T>(), self.inner.name)
    }
}

static NEXT_ID: AtomicU64 = AtomicU64::new(0);

fn allocate(device: &Arc<DeviceInner>, name: &'static str, bytes: u64) -> Result<Arc<BufferInner>, Error> {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER
        | vk::BufferUsageFlags::INDIRECT_BUFFER
        | vk::BufferUsageFlags::TRANSFER_SRC
        | vk::BufferUsageFlags::TRANSFER_DST
        | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
    let memory = Allocated::new(device, name, bytes, usage, MemoryLocation::GpuOnly)?;
    let info = vk::BufferDeviceAddressInfo::default().buffer(memory.buffer);
    // SAFETY: the buffer has memory and was made for its address to be taken.
    let address = unsafe { device.raw.get_buffer_device_address(&info) };
    let id = NEXT_ID.fetch_add(1, Ordering::Relaxed);
    let made = Arc::new(BufferInner { name, id, address, memory, device: Arc::clone(device) });
    if made.memory.guard > 0 {
        let mut guarded = device.guarded();
        guarded.retain(|known| known.strong_count() > 0);
        guarded.push(Arc::downgrade(&made));
    }
    Ok(made)
}

fn bytes_of<T>(len: usize) -> u64 {
    (len as u64).saturating_mul(size_of::<T>() as u64)
}

impl<T: Pod> Buffer<T> {
    /// Room for `len` elements. The name stands in errors.
    pub fn new(device: &Device, name: &'static str, len: usize) -> Result<Self, Error> {
        let bytes = bytes_of::<T>(len);
        let (inner, start) = match device.pool.as_ref().and_then(|pool| pool.take(bytes)) {
            Some(found) => found,
            None => {
                let inner = allocate(&device.inner, name, bytes)?;
                let start = inner.memory.guard;
                (inner, start)
            }
        };
        Ok(Buffer { inner, start, len, of: PhantomData })
    }

    /// Lets buffers that are made later have its memory: nothing recorded from now on may need what it holds.
    pub fn give(&self, pool: &Pool) {
        pool.give(&self.inner, self.start, bytes_of::<T>(self.len));
    }

    /// Room for at least `len` elements; the length becomes `len`. Grows by half of what there was at least, so that
    /// growing step by step costs little; what it held is gone when it grows. Whether it grew.
    ///
    /// The old memory is given back first, unless a recording holds it.
    pub fn resize(&mut self, len: usize) -> Result<bool, Error> {
        if self.start == self.inner.memory.guard && bytes_of::<T>(len) <= self.inner.memory.bytes {
            self.len = len;
            return Ok(false);
        }
        let old = self.inner.memory.bytes;
        let (device, name) = (Arc::clone(&self.inner.device), self.inner.name);
        let wanted = bytes_of::<T>(len);
        let limits = &device.info.limits;
        let roomy = wanted.max(old.saturating_add(old / 2)).min(limits.buffer_bytes);
        self.len = 0;
        self.inner = allocate(&device, name, 0)?;
        self.inner = match allocate(&device, name, roomy.max(wanted)) {
            Err(Error::OutOfMemory { .. } | Error::TooLarge { .. }) if roomy > wanted => {
                allocate(&device, name, wanted)?
            }
            other => other?,
        };
        (self.start, self.len) = (self.inner.memory.guard, len);
        Ok(true)
    }

    /// Elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All elements.
    pub fn view(&self) -> View<'_, T> {
        View { buffer: &self.inner, start: self.start, len: self.len, of: PhantomData }
    }

    /// Some elements. The first must lie at a multiple of [`VIEW_ALIGN`] bytes.
    pub fn slice(&self, range: Range<usize>) -> Result<View<'_, T>, Error> {
        self.view().slice(range)
    }
}

/// Some elements of a buffer: what kernels and commands take.
pub struct View<'a, T> {
    pub(crate) buffer: &'a Arc<BufferInner>,
    pub(crate) start: u64,
    len: usize,
    of: PhantomData<fn() -> T>,
}

impl<T> Clone for View<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for View<'_, T> {}

impl<T> std::fmt::Debug for View<'_, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "View({} x {} of `{}` from byte {})",
            self.len,
            std::any::type_name::<T>(),
            self.buffer.name,
            self.start
        )
    }
}

impl<'a> View<'a, u32> {
    /// The words of a part of a buffer.
    pub(crate) fn of_touch(touch: &'a Touch) -> Self {
        let len = ((touch.end - touch.start) / 4) as usize;
        View { buffer: &touch.buffer, start: touch.start, len, of: PhantomData }
    }
}

impl<'a, T: Pod> View<'a, T> {
    /// Elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Some of these elements. The first must lie at a multiple of [`VIEW_ALIGN`] bytes of the buffer.
    pub fn slice(&self, range: Range<usize>) -> Result<View<'a, T>, Error> {
        let Range { start, end } = range;
        let failed = |why| Err(Error::Range { buffer: self.buffer.name, start, end, len: self.len, why });
        if start > end || end > self.len {
            return failed("it does not lie in the buffer");
        }
        let from = self.start + bytes_of::<T>(start);
        if !from.is_multiple_of(VIEW_ALIGN as u64) {
            return failed("it does not begin at a multiple of 16 bytes");
        }
        Ok(View { buffer: self.buffer, start: from, len: end - start, of: PhantomData })
    }

    /// The same bytes as elements of another type; what does not fill one is left out.
    pub fn cast<U: Pod>(&self) -> View<'a, U> {
        let len = self.bytes().checked_div(size_of::<U>() as u64).unwrap_or(0) as usize;
        View { buffer: self.buffer, start: self.start, len, of: PhantomData }
    }

    /// The address of the first byte on the device.
    pub fn device_address(&self) -> u64 {
        self.buffer.address + self.start
    }

    /// Bytes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<T>(self.len)
    }
}
