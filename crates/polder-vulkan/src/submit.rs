//! Command buffers on their way: recorded, submitted, waited for by one timeline semaphore, and kept with all that they
//! use while the device may still work on them.

use crate::Error;
use crate::ahead::Ahead;
use crate::buffer::BufferInner;
use crate::device::{Device, DeviceInner};
use crate::error::Called;
use crate::info::DeviceKind;
use crate::kernel::KernelInner;
use crate::memory::Allocated;
use crate::queries::Queries;
use ash::vk;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a wait looks again and again before it sleeps: a wake-up costs tens of microseconds.
const SPIN: Duration = Duration::from_micros(100);
/// How long dropping an engine waits for a device that did not finish in time.
const LAST_WAIT: Duration = Duration::from_secs(10);

/// A command buffer in a pool of its own.
pub(crate) struct Slot {
    pool: vk::CommandPool,
    pub(crate) commands: vk::CommandBuffer,
}

/// What was not done in time, until it is.
struct Parked {
    value: u64,
    slot: Slot,
    _used: Used,
}

/// All that a submission uses.
#[derive(Default)]
pub(crate) struct Used {
    pub(crate) buffers: Vec<Arc<BufferInner>>,
    pub(crate) kernels: Vec<Arc<KernelInner>>,
    pub(crate) staging: Vec<Allocated>,
    #[expect(dead_code, reason = "held, not read")]
    pub(crate) queries: Option<Queries>,
    #[expect(dead_code, reason = "held, not read")]
    pub(crate) ahead: Option<Ahead>,
}

pub(crate) struct Submitter {
    pub(crate) device: Arc<DeviceInner>,
    timeline: vk::Semaphore,
    last: u64,
    free: Vec<Slot>,
    parked: Vec<Parked>,
    spin: Duration,
    pub(crate) submissions: u32,
    pub(crate) waits: u32,
}

impl Submitter {
    pub(crate) fn new(device: &Device) -> Result<Self, Error> {
        let device = Arc::clone(&device.inner);
        device.alive()?;
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: the device is alive and has timeline semaphores.
        let timeline = unsafe { device.raw.create_semaphore(&info, None) }.called("vkCreateSemaphore")?;
        // A CPU that plays the device needs the core that would spin.
        let spin = if device.info.kind == DeviceKind::Cpu { Duration::ZERO } else { SPIN };
        Ok(Submitter {
            device,
            timeline,
            last: 0,
            free: Vec::new(),
            parked: Vec::new(),
            spin,
            submissions: 0,
            waits: 0,
        })
    }

    /// A command buffer that takes commands, ordered after all earlier work on the queue.
    pub(crate) fn begin(&mut self) -> Result<Slot, Error> {
        self.device.alive()?;
        self.reap();
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None => self.make()?,
        };
        let raw = &self.device.raw;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: no command buffer of this pool is in flight: it came from the free ones.
        let begun = unsafe {
            raw.reset_command_pool(slot.pool, vk::CommandPoolResetFlags::empty())
                .and_then(|()| raw.begin_command_buffer(slot.commands, &info))
        };
        if let Err(error) = self.device.note(begun.called("vkBeginCommandBuffer")) {
            self.free.push(slot);
            return Err(error);
        }
        let everything = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        // SAFETY: the command buffer is being recorded.
        unsafe {
            raw.cmd_pipeline_barrier2(slot.commands, &vk::DependencyInfo::default().memory_barriers(&everything))
        };
        Ok(slot)
    }

    fn make(&self) -> Result<Slot, Error> {
        let raw = &self.device.raw;
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.family)
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is alive and has this family.
        let pool = unsafe { raw.create_command_pool(&info, None) }.called("vkCreateCommandPool")?;
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool was made a moment ago.
        match unsafe { raw.allocate_command_buffers(&info) } {
            Ok(made) => Ok(Slot { pool, commands: made[0] }),
            Err(result) => {
                // SAFETY: nothing was allocated from it.
                unsafe { raw.destroy_command_pool(pool, None) };
                Err(result).called("vkAllocateCommandBuffers")
            }
        }
    }

    /// Hands the commands to the device; the value that the semaphore will reach.
    pub(crate) fn submit(&mut self, slot: &Slot) -> Result<u64, Error> {
        let device = Arc::clone(&self.device);
        // SAFETY: the command buffer is being recorded.
        let ended = unsafe { device.raw.end_command_buffer(slot.commands) };
        device.note(ended.called("vkEndCommandBuffer"))?;
        if device.faults.submission_fails() {
            return device.note(Err(Error::DeviceLost));
        }
        let value = self.last + 1;
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(slot.commands)];
        let signal = [vk::SemaphoreSubmitInfo::default()
            .semaphore(self.timeline)
            .value(value)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)];
        let info = [vk::SubmitInfo2::default().command_buffer_infos(&commands).signal_semaphore_infos(&signal)];
        let queue = device.queue();
        // SAFETY: the queue is of this device and locked; the commands are ended, and all that they use is kept alive by
        // the caller until the semaphore reaches the value, or parked.
        let submitted = unsafe { device.raw.queue_submit2(*queue, &info, vk::Fence::null()) };
        drop(queue);
        device.note(submitted.called("vkQueueSubmit2"))?;
        self.last = value;
        self.submissions += 1;
        Ok(value)
    }

    /// Waits until the device has reached the value.
    pub(crate) fn wait(&mut self, value: u64, timeout: Duration) -> Result<(), Error> {
        self.waits += 1;
        let seconds = timeout.as_secs_f64();
        if self.device.faults.wait_fails() {
            return Err(Error::Timeout { seconds });
        }
        let start = Instant::now();
        while start.elapsed() < self.spin.min(timeout) {
            if self.reached()? >= value {
                return Ok(());
            }
            std::hint::spin_loop();
        }
        let (semaphores, values) = ([self.timeline], [value]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        let left = timeout.saturating_sub(start.elapsed());
        let nanoseconds = u64::try_from(left.as_nanos()).unwrap_or(u64::MAX);
        // SAFETY: the semaphore is a timeline of this device.
        match unsafe { self.device.raw.wait_semaphores(&info, nanoseconds) } {
            Err(vk::Result::TIMEOUT) => Err(Error::Timeout { seconds }),
            other => self.device.note(other.called("vkWaitSemaphores")),
        }
    }

    fn reached(&self) -> Result<u64, Error> {
        // SAFETY: the semaphore is a timeline of this device.
        let value = unsafe { self.device.raw.get_semaphore_counter_value(self.timeline) };
        self.device.note(value.called("vkGetSemaphoreCounterValue"))
    }

    /// Takes back a command buffer that the device is done with, or never got.
    pub(crate) fn done(&mut self, slot: Slot) {
        self.free.push(slot);
    }

    /// Keeps what a submission uses until the device is done with it.
    pub(crate) fn park(&mut self, slot: Slot, value: u64, used: Used) {
        self.parked.push(Parked { value, slot, _used: used });
    }

    /// Lets go of what is done by now.
    fn reap(&mut self) {
        if self.parked.is_empty() {
            return;
        }
        let Ok(reached) = self.reached() else { return };
        let (done, waiting) = self.parked.drain(..).partition(|parked| parked.value <= reached);
        self.parked = waiting;
        let done: Vec<Parked> = done;
        self.free.extend(done.into_iter().map(|parked| parked.slot));
    }
}

impl Drop for Submitter {
    fn drop(&mut self) {
        // A lost device is done with everything, by specification.
        let in_flight = !self.parked.is_empty() && self.device.alive().is_ok();
        if in_flight && self.wait(self.last, LAST_WAIT) == Err(Error::Timeout { seconds: LAST_WAIT.as_secs_f64() }) {
            // What hangs is never given back: freeing it would pull it from under the device.
            std::mem::forget(std::mem::take(&mut self.parked));
            std::mem::forget(Arc::clone(&self.device));
            return;
        }
        let slots = self.free.drain(..).chain(self.parked.drain(..).map(|parked| parked.slot));
        for slot in slots {
            // SAFETY: the device is done with every command buffer.
            unsafe { self.device.raw.destroy_command_pool(slot.pool, None) };
        }
        // SAFETY: nothing waits for it or will signal it.
        unsafe { self.device.raw.destroy_semaphore(self.timeline, None) };
    }
}
