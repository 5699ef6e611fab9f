//! The engine runs recordings: the only place that turns them into commands of Vulkan.

use crate::Error;
use crate::device::Device;
use crate::hazards::{Barrier, Hazards, Scope, Use};
use crate::memory::Allocated;
use crate::queries::Queries;
use crate::recording::{ReadBack, Recording, Size, Step, held};
use crate::shader::Touch;
use crate::submit::{Slot, Submitter, Used};
use crate::timing::Timings;
use crate::transfer::Staging;
use ash::vk;
use gpu_allocator::MemoryLocation;
use std::time::Duration;

/// How to run a recording.
pub struct RunOptions<'a> {
    /// Whether each command is timed.
    pub timestamps: bool,
    /// How long each wait for the device may take.
    pub timeout: Duration,
    /// Asked after each batch of a repeated body: true stops with [`Error::Cancelled`].
    pub cancel: Option<&'a dyn Fn() -> bool>,
    /// Told after each batch of a repeated body: its name, and its rounds so far.
    pub progress: Option<&'a dyn Fn(&'static str, u32)>,
}

impl Default for RunOptions<'_> {
    /// No timestamps, a minute, nobody asked or told.
    fn default() -> Self {
        RunOptions { timestamps: false, timeout: Duration::from_secs(60), cancel: None, progress: None }
    }
}

impl std::fmt::Debug for RunOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunOptions").field("timestamps", &self.timestamps).finish_non_exhaustive()
    }
}

/// What a run did.
#[derive(Debug, Clone, Default)]
pub struct RunReport {
    /// Times the host handed work to the device.
    pub submissions: u32,
    /// Times the host waited for it.
    pub waits: u32,
    /// Kernels dispatched.
    pub dispatches: u32,
    /// Barriers recorded.
    pub barriers: u32,
    /// Rounds of every repeated body, in the order in which they ended.
    pub rounds: Vec<(&'static str, u32)>,
    /// Timestamps, if asked for.
    pub timings: Timings,
    words: Vec<u32>,
}

impl RunReport {
    /// The words that [`Recording::read`] asked for.
    pub fn words(&self, read: ReadBack) -> &[u32] {
        let first = read.first as usize;
        self.words.get(first..first + read.len as usize).unwrap_or(&[])
    }

    /// The first of them; zero if there are none.
    pub fn word(&self, read: ReadBack) -> u32 {
        self.words(read).first().copied().unwrap_or(0)
    }
}

/// Runs recordings on one device. Engines of one device take turns on its queue.
pub struct Engine {
    pub(crate) submitter: Submitter,
    pub(crate) staging: Staging,
    readback: Option<Allocated>,
    queries: Option<Queries>,
    hazards: Hazards,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Engine({})", self.submitter.device.info.name)
    }
}

impl Engine {
    /// An engine with nothing to do.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Engine {
            submitter: Submitter::new(device)?,
            staging: Staging::default(),
            readback: None,
            queries: None,
            hazards: Hazards::default(),
        })
    }

    /// Its device.
    pub fn device(&self) -> Device {
        Device { inner: self.submitter.device.clone() }
    }

    /// Runs a recording to its end. It can be run again.
    pub fn run(&mut self, recording: &Recording, options: &RunOptions<'_>) -> Result<RunReport, Error> {
        if let Some(error) = &recording.error {
            return Err(error.clone());
        }
        if !std::sync::Arc::ptr_eq(&recording.device, &self.submitter.device) {
            let why = "it was recorded for another device".to_owned();
            return Err(Error::Recording { command: "run", why });
        }
        self.submitter.device.alive()?;
        self.make_room(recording.words)?;
        if options.timestamps && self.queries.is_none() && self.submitter.device.info.timestamps {
            self.queries = Some(Queries::new(&self.submitter.device)?);
        }
        let (submissions, waits) = (self.submitter.submissions, self.submitter.waits);
        let mut run = Run { engine: self, recording, options, open: None, report: RunReport::default() };
        let done = run.steps(&recording.steps).and_then(|()| run.flush());
        let Run { open, mut report, .. } = run;
        if let Some(slot) = open {
            self.submitter.done(slot);
        }
        if done.is_err() {
            // Stamps of commands that never ran.
            self.queries.iter_mut().for_each(Queries::forget);
        }
        done?;
        report.submissions = self.submitter.submissions - submissions;
        report.waits = self.submitter.waits - waits;
        report.words = self.words(recording.words);
        Ok(report)
    }

    fn make_room(&mut self, words: u32) -> Result<(), Error> {
        let bytes = u64::from(words.max(64)).next_power_of_two() * 4;
        if self.readback.as_ref().is_none_or(|buffer| buffer.bytes < bytes) {
            let device = &self.submitter.device;
            let usage = vk::BufferUsageFlags::TRANSFER_DST;
            self.readback = None;
            self.readback = Some(Allocated::new(device, "read-back words", bytes, usage, MemoryLocation::GpuToCpu)?);
        }
        Ok(())
    }

    fn words(&self, words: u32) -> Vec<u32> {
        let mapped = self.readback.as_ref().and_then(Allocated::mapped).unwrap_or(&[]);
        let bytes = mapped.get(..words as usize * 4).unwrap_or(&[]);
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
    }

    fn word(&self, read: ReadBack) -> u32 {
        self.words(read.first + 1).last().copied().unwrap_or(0)
    }
}

struct Run<'e, 'o> {
    engine: &'e mut Engine,
    recording: &'e Recording,
    options: &'e RunOptions<'o>,
    open: Option<Slot>,
    report: RunReport,
}

impl Run<'_, '_> {
    fn steps(&mut self, steps: &[Step]) -> Result<(), Error> {
        for step in steps {
            if self.options.timestamps && self.engine.queries.as_ref().is_some_and(Queries::is_full) {
                self.flush()?;
            }
            match step {
                Step::Dispatch { kernel, size, arguments, touches } => {
                    let mut uses: Vec<Use> = touches.iter().map(|touch| used(touch, Scope::Compute)).collect();
                    if let Size::Indirect(groups) = size {
                        uses.push(used(groups, Scope::Indirect));
                    }
                    let commands = self.order(&uses)?;
                    self.stamp(commands, kernel.name, false);
                    let raw = &self.engine.submitter.device.raw;
                    let compute = vk::ShaderStageFlags::COMPUTE;
                    // SAFETY: the command buffer is being recorded; kernel and buffers are of this device and are kept
                    // until the device is done; workgroups are within its limits, sizes from a buffer too as kernels
                    // fold them.
                    unsafe {
                        raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, kernel.pipeline);
                        raw.cmd_push_constants(commands, kernel.layout, compute, 0, arguments);
                        match size {
                            Size::Direct([x, y, z]) => raw.cmd_dispatch(commands, *x, *y, *z),
                            Size::Indirect(groups) => {
                                raw.cmd_dispatch_indirect(commands, groups.buffer.memory.buffer, groups.start);
                            }
                        }
                    }
                    self.stamp(commands, kernel.name, true);
                    self.report.dispatches += 1;
                }
                Step::Fill { to, value } => {
                    let commands = self.order(&[used(to, Scope::Transfer)])?;
                    self.stamp(commands, "fill", false);
                    let raw = &self.engine.submitter.device.raw;
                    let bytes = to.end - to.start;
                    // SAFETY: as above; views of words begin and end at multiples of 4 bytes.
                    unsafe { raw.cmd_fill_buffer(commands, to.buffer.memory.buffer, to.start, bytes, *value) };
                    self.stamp(commands, "fill", true);
                }
                Step::Copy { from, to } => {
                    let commands = self.order(&[used(from, Scope::Transfer), used(to, Scope::Transfer)])?;
                    self.stamp(commands, "copy", false);
                    self.copy(commands, from, to.buffer.memory.buffer, to.start);
                    self.stamp(commands, "copy", true);
                }
                Step::Read { from, to } => self.read(from, *to)?,
                Step::Repeat { name, counter, read, bound, batch, body } => {
                    self.repeat(name, counter, *read, (*bound, *batch), body)?;
                }
            }
        }
        Ok(())
    }

    fn repeat(
        &mut self,
        name: &'static str,
        counter: &Touch,
        read: ReadBack,
        (bound, batch): (u32, u32),
        body: &[Step],
    ) -> Result<(), Error> {
        let mut rounds = 0;
        loop {
            let now = batch.min(bound - rounds);
            for _ in 0..now {
                self.steps(body)?;
            }
            rounds += now;
            self.read(counter, read)?;
            self.flush()?;
            if let Some(tell) = self.options.progress {
                tell(name, rounds);
            }
            if self.engine.word(read) == 0 {
                self.report.rounds.push((name, rounds));
                return Ok(());
            }
            if rounds >= bound {
                return Err(Error::Bound { name, bound });
            }
            if self.options.cancel.is_some_and(|cancel| cancel()) {
                return Err(Error::Cancelled);
            }
        }
    }

    fn read(&mut self, from: &Touch, to: ReadBack) -> Result<(), Error> {
        let commands = self.order(&[used(from, Scope::Transfer)])?;
        let Some(readback) = self.engine.readback.as_ref().map(|readback| readback.buffer) else { return Ok(()) };
        self.copy(commands, from, readback, u64::from(to.first) * 4);
        Ok(())
    }

    fn copy(&self, commands: vk::CommandBuffer, from: &Touch, to: vk::Buffer, at: u64) {
        let region = vk::BufferCopy::default().src_offset(from.start).dst_offset(at).size(from.end - from.start);
        let raw = &self.engine.submitter.device.raw;
        // SAFETY: the command buffer is being recorded; both ranges lie in their buffers, which the recording checked, do
        // not overlap, and are kept until the device is done.
        unsafe { raw.cmd_copy_buffer(commands, from.buffer.memory.buffer, to, &[region]) };
    }

    /// The open command buffer, behind whatever barrier these uses need.
    fn order(&mut self, uses: &[Use]) -> Result<vk::CommandBuffer, Error> {
        let commands = match &self.open {
            Some(slot) => slot.commands,
            None => {
                // A fresh command buffer begins behind everything before it.
                self.engine.hazards.clear();
                self.open.insert(self.engine.submitter.begin()?).commands
            }
        };
        if let Some(barrier) = self.engine.hazards.before(uses) {
            record_barrier(&self.engine.submitter.device.raw, commands, barrier);
            self.report.barriers += 1;
        }
        Ok(commands)
    }

    fn stamp(&mut self, commands: vk::CommandBuffer, name: &'static str, after: bool) {
        if self.options.timestamps
            && let Some(queries) = &mut self.engine.queries
        {
            queries.stamp(commands, name, after);
        }
    }

    /// Submits what is open and waits until it is done.
    fn flush(&mut self) -> Result<(), Error> {
        let Some(slot) = self.open.take() else { return Ok(()) };
        host_reads(&self.engine.submitter.device.raw, slot.commands);
        let value = match self.engine.submitter.submit(&slot) {
            Ok(value) => value,
            Err(error) => {
                self.open = Some(slot);
                return Err(error);
            }
        };
        match self.engine.submitter.wait(value, self.options.timeout) {
            Ok(()) => self.engine.submitter.done(slot),
            Err(error) => {
                // The device may still be at it.
                let mut used = Used { queries: self.engine.queries.take(), ..Used::default() };
                held(&self.recording.steps, &mut used.buffers, &mut used.kernels);
                used.staging.extend(self.engine.readback.take());
                self.engine.submitter.park(slot, value, used);
                return Err(error);
            }
        }
        if let Some(queries) = &mut self.engine.queries {
            queries.collect(&mut self.report.timings)?;
        }
        Ok(())
    }
}

fn used(touch: &Touch, scope: Scope) -> Use {
    Use { buffer: touch.buffer.id, start: touch.start, end: touch.end, scope, write: touch.write }
}

fn stages(scopes: u8) -> vk::PipelineStageFlags2 {
    let mut stages = vk::PipelineStageFlags2::empty();
    for (scope, stage) in [
        (Scope::Compute, vk::PipelineStageFlags2::COMPUTE_SHADER),
        (Scope::Transfer, vk::PipelineStageFlags2::ALL_TRANSFER),
        (Scope::Indirect, vk::PipelineStageFlags2::DRAW_INDIRECT),
    ] {
        if scopes & scope as u8 != 0 {
            stages |= stage;
        }
    }
    stages
}

fn accesses(scopes: u8, reads: bool) -> vk::AccessFlags2 {
    let mut accesses = vk::AccessFlags2::empty();
    for (scope, read, write) in [
        (Scope::Compute, vk::AccessFlags2::SHADER_STORAGE_READ, vk::AccessFlags2::SHADER_STORAGE_WRITE),
        (Scope::Transfer, vk::AccessFlags2::TRANSFER_READ, vk::AccessFlags2::TRANSFER_WRITE),
        (Scope::Indirect, vk::AccessFlags2::INDIRECT_COMMAND_READ, vk::AccessFlags2::empty()),
    ] {
        if scopes & scope as u8 != 0 {
            accesses |= if reads { read | write } else { write };
        }
    }
    accesses
}

fn record_barrier(raw: &ash::Device, commands: vk::CommandBuffer, barrier: Barrier) {
    let memory = [vk::MemoryBarrier2::default()
        .src_stage_mask(stages(barrier.from))
        .src_access_mask(accesses(barrier.from, false))
        .dst_stage_mask(stages(barrier.to))
        .dst_access_mask(accesses(barrier.to, true))];
    // SAFETY: the command buffer is being recorded.
    unsafe { raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&memory)) };
}

/// What transfers wrote becomes visible to the host once it has waited.
pub(crate) fn host_reads(raw: &ash::Device, commands: vk::CommandBuffer) {
    let memory = [vk::MemoryBarrier2::default()
        .src_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
        .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
        .dst_stage_mask(vk::PipelineStageFlags2::HOST)
        .dst_access_mask(vk::AccessFlags2::HOST_READ)];
    // SAFETY: the command buffer is being recorded.
    unsafe { raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&memory)) };
}
