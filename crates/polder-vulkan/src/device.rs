//! A device: opened here, or lent by a caller.

use crate::buffer::BufferInner;
use crate::cache::{CacheFolder, PipelineCache};
use crate::error::Called;
use crate::faults::Faults;
use crate::info::{DeviceInfo, Feature};
use crate::instance::{Instance, one_at_a_time};
use crate::kernel::Pipelines;
use crate::memory::{Memory, MemoryUse};
use crate::pool::Pool;
use crate::self_test::SelfTest;
use crate::{Error, Selection};
use ash::vk;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// How to open a device.
#[derive(Debug, Clone, Default)]
pub struct DeviceOptions {
    /// Which one.
    pub selection: Selection,
    /// Whether the validation layer watches.
    pub validation: bool,
    /// Bytes of device memory that may be held at once.
    pub memory_cap: Option<u64>,
    /// Where compiled pipelines are kept.
    pub cache: CacheFolder,
    /// Whether every buffer stands between guard zones of 16 KiB, in memory that the host sees, so that
    /// [`Device::overruns`] can tell which kernels wrote past an end. For tests: it is slow on a GPU.
    pub guarded: bool,
}

/// A device, queue and, if wanted, allocator that a caller owns and lends.
pub struct Lent {
    /// The instance.
    pub instance: ash::Instance,
    /// The device's physical device.
    pub physical: vk::PhysicalDevice,
    /// The device.
    pub device: ash::Device,
    /// A queue that computes.
    pub queue: vk::Queue,
    /// The queue's family.
    pub family: u32,
    /// Enabled features of [`Feature::OPTIONAL`].
    pub optional: Vec<Feature>,
    /// The allocator; one is made if there is none.
    pub allocator: Option<Arc<Mutex<Allocator>>>,
    /// Bytes of device memory that may be held at once.
    pub memory_cap: Option<u64>,
    /// Where compiled pipelines are kept.
    pub cache: CacheFolder,
}

pub(crate) struct DeviceInner {
    pub(crate) info: DeviceInfo,
    pub(crate) raw: ash::Device,
    queue: Mutex<vk::Queue>,
    pub(crate) family: u32,
    pub(crate) memory: Memory,
    pub(crate) cache: PipelineCache,
    pub(crate) pipelines: Pipelines,
    pub(crate) faults: Faults,
    pub(crate) self_test: OnceLock<SelfTest>,
    guarded: Mutex<Vec<Weak<BufferInner>>>,
    lost: AtomicBool,
    owned: bool,
    pub(crate) instance: Instance,
}

/// A device that computes. Clones share it.
#[derive(Clone)]
pub struct Device {
    pub(crate) inner: Arc<DeviceInner>,
    pub(crate) pool: Option<Pool>,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Device({})", self.inner.info.name)
    }
}

impl Device {
    /// Loads Vulkan and opens a device.
    pub fn open(options: &DeviceOptions) -> Result<Self, Error> {
        Device::open_on(&Instance::load(options.validation)?, options)
    }

    /// Opens a device of an instance that is loaded already.
    pub fn open_on(instance: &Instance, options: &DeviceOptions) -> Result<Self, Error> {
        let devices = instance.devices()?;
        let info = options.selection.pick(&devices)?.clone();
        let family = info.family.ok_or_else(|| Error::Unsupported {
            device: info.name.clone(),
            missing: "a queue that computes".to_owned(),
        })?;
        let has = |feature| info.features.contains(&feature);
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default()
            .buffer_device_address(true)
            .timeline_semaphore(true)
            .host_query_reset(true);
        let mut vulkan13 = vk::PhysicalDeviceVulkan13Features::default()
            .synchronization2(true)
            .subgroup_size_control(true)
            .compute_full_subgroups(true);
        let plain =
            vk::PhysicalDeviceFeatures::default().shader_int64(true).shader_float64(has(Feature::ShaderFloat64));
        let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
        let mut extensions = Vec::new();
        if info.portability_subset {
            extensions.push(c"VK_KHR_portability_subset".as_ptr());
        }
        let description = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&plain)
            .push_next(&mut vulkan12)
            .push_next(&mut vulkan13);
        let alone = one_at_a_time();
        // SAFETY: the physical device is of this instance; features, extensions and queue were found there.
        let raw =
            unsafe { instance.inner.raw.create_device(info.physical, &description, None) }.called("vkCreateDevice")?;
        drop(alone);
        // SAFETY: one queue of this family was asked for.
        let queue = unsafe { raw.get_device_queue(family, 0) };
        Device::build(
            instance.clone(),
            info,
            raw,
            queue,
            family,
            None,
            options.memory_cap,
            &options.cache,
            true,
            options.guarded,
        )
    }

    /// Computes on a device that the caller owns; nothing of it is destroyed here.
    ///
    /// # Safety
    ///
    /// The handles belong together and stay alive until every clone of the device, and everything made from it, is gone.
    /// The device has all of [`requirements`](crate::requirements) and the named optional features *enabled*, which
    /// Vulkan gives no way to ask. Nobody else uses the queue while a call here uses it. A lent allocator allocates
    /// memory whose addresses can be taken.
    pub unsafe fn borrow(lent: Lent) -> Result<Self, Error> {
        let instance = Instance::borrowed(lent.instance);
        let mut info = DeviceInfo::of(&instance.inner.raw, lent.physical, 0);
        if !info.usable() {
            return Err(Error::Unsupported { device: info.name, missing: info.missing.join(", ") });
        }
        info.features.retain(|feature| Feature::REQUIRED.contains(feature) || lent.optional.contains(feature));
        info.family = Some(lent.family);
        let Lent { device, queue, family, allocator, memory_cap, cache, .. } = lent;
        Device::build(instance, info, device, queue, family, allocator, memory_cap, &cache, false, false)
    }

    #[expect(clippy::too_many_arguments, reason = "one place that puts everything together")]
    fn build(
        instance: Instance,
        info: DeviceInfo,
        raw: ash::Device,
        queue: vk::Queue,
        family: u32,
        allocator: Option<Arc<Mutex<Allocator>>>,
        memory_cap: Option<u64>,
        cache: &CacheFolder,
        owned: bool,
        guarded: bool,
    ) -> Result<Self, Error> {
        let destroy = |raw: &ash::Device| {
            if owned {
                // SAFETY: made a moment ago, and nothing was made from it that is left.
                unsafe { raw.destroy_device(None) };
            }
        };
        let cache = PipelineCache::open(&raw, cache, &info.cache_name).inspect_err(|_| destroy(&raw))?;
        let allocator = match allocator {
            Some(allocator) => allocator,
            None => {
                let description = AllocatorCreateDesc {
                    instance: instance.inner.raw.clone(),
                    device: raw.clone(),
                    physical_device: info.physical,
                    debug_settings: Default::default(),
                    buffer_device_address: true,
                    allocation_sizes: Default::default(),
                };
                let made = Allocator::new(&description).map_err(|error| {
                    cache.destroy(&raw);
                    destroy(&raw);
                    Error::OutOfMemory { what: error.to_string(), bytes: 0, used: 0 }
                });
                Arc::new(Mutex::new(made?))
            }
        };
        let inner = DeviceInner {
            info,
            raw,
            queue: Mutex::new(queue),
            family,
            memory: Memory::new(allocator, memory_cap, guarded),
            cache,
            pipelines: Pipelines::default(),
            faults: Faults::of_environment(),
            self_test: OnceLock::new(),
            guarded: Mutex::default(),
            lost: AtomicBool::new(false),
            owned,
            instance,
        };
        Ok(Device { inner: Arc::new(inner), pool: None })
    }

    /// The same device, on which buffers take memory from a pool before any is allocated.
    #[must_use]
    pub fn reusing(&self, pool: &Pool) -> Self {
        Device { inner: Arc::clone(&self.inner), pool: Some(pool.clone()) }
    }

    /// What the device is and can do.
    pub fn info(&self) -> &DeviceInfo {
        &self.inner.info
    }

    /// Whether the device has an optional feature, enabled.
    pub fn has(&self, feature: Feature) -> bool {
        self.inner.info.features.contains(&feature)
    }

    /// Bytes of device memory held through this device.
    pub fn memory_use(&self) -> MemoryUse {
        self.inner.memory.usage()
    }

    /// Bytes of device memory that may still be allocated.
    pub fn available_memory(&self) -> u64 {
        self.inner.available_memory()
    }

    /// Whether the device was lost: every further call fails, and a new device has to be opened.
    pub fn is_lost(&self) -> bool {
        self.inner.lost.load(Ordering::Relaxed)
    }

    /// Failures on demand, for tests.
    pub fn faults(&self) -> &Faults {
        &self.inner.faults
    }

    /// Writes past an end of a buffer, of those that are there and those that were, if the device was opened with
    /// [`DeviceOptions::guarded`]; those of more than 16 KiB past it are not seen.
    pub fn overruns(&self) -> Vec<String> {
        let mut all = self.inner.memory.overruns();
        let live: Vec<_> = self.inner.guarded().iter().filter_map(Weak::upgrade).collect();
        all.extend(live.iter().filter_map(|buffer| buffer.memory.overrun()));
        all
    }

    /// What the validation layer has said; empty without it.
    pub fn validation_messages(&self) -> Vec<String> {
        self.inner.instance.messages()
    }

    /// Compiles all kernels that were made on this device and are not compiled yet, side by side by all threads of
    /// rayon's pool. An engine does the same before it runs anything.
    pub fn compile(&self) -> Result<(), Error> {
        self.inner.pipelines.compile(&self.inner)
    }

    /// Pipelines made so far or to be made: one for each kernel and choice of its constants.
    pub fn pipelines(&self) -> usize {
        self.inner.pipelines.count()
    }

    /// Writes newly compiled pipelines to the cache. Done when the device goes, too.
    pub fn save_pipelines(&self) {
        self.inner.cache.save(&self.inner.raw);
    }
}

impl DeviceInner {
    pub(crate) fn guarded(&self) -> MutexGuard<'_, Vec<Weak<BufferInner>>> {
        self.guarded.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fails if the device is lost.
    pub(crate) fn alive(&self) -> Result<(), Error> {
        if self.lost.load(Ordering::Relaxed) { Err(Error::DeviceLost) } else { Ok(()) }
    }

    /// Remembers a loss.
    pub(crate) fn note<T>(&self, result: Result<T, Error>) -> Result<T, Error> {
        if matches!(result, Err(Error::DeviceLost)) {
            self.lost.store(true, Ordering::Relaxed);
        }
        result
    }
}

impl Drop for DeviceInner {
    fn drop(&mut self) {
        let _alone = one_at_a_time();
        if self.owned {
            // Whatever is in flight after a timeout has to end before the memory goes; a lost device answers at once.
            // SAFETY: the device is alive and nobody else can hold its queue any more.
            let _ = unsafe { self.raw.device_wait_idle() };
        }
        self.cache.save(&self.raw);
        self.cache.destroy(&self.raw);
        self.pipelines.destroy(&self.raw);
        if self.owned {
            self.memory.release();
            // SAFETY: everything made from the device kept it alive, so all of that is gone.
            unsafe { self.raw.destroy_device(None) };
        }
    }
}
