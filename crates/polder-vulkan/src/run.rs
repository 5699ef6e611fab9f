//! One run of a recording: steps become commands, in order, with the barriers between them.

use crate::Error;
use crate::ahead::Guard;
use crate::engine::{Engine, RunOptions, RunReport};
use crate::hazards::{Barrier, Scope, Use};
use crate::kernel::KernelInner;
use crate::queries::Queries;
use crate::recording::{ReadBack, Recording, Repeat, Size, Step, held};
use crate::shader::Touch;
use crate::submit::{Slot, Used};
use ash::vk;

/// The batches of a loop that was run ahead and not done double at each look, so often at most.
const MOST_DOUBLINGS: u32 = 6;

/// Why a run does not simply go on.
pub(crate) enum Stop {
    /// It failed.
    Failed(Error),
    /// A loop that was run ahead was not done: nothing behind it has run.
    Halted(Guard),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Stop::Failed(error)
    }
}

pub(crate) struct Run<'e, 'o> {
    pub(crate) engine: &'e mut Engine,
    pub(crate) recording: &'e Recording,
    options: &'e RunOptions<'o>,
    open: Option<Slot>,
    pub(crate) report: RunReport,
    /// Loops that were run ahead and not looked at yet, in order.
    pub(crate) guards: Vec<Guard>,
    section: Option<&'static str>,
}

impl<'e, 'o> Run<'e, 'o> {
    pub(crate) fn new(engine: &'e mut Engine, recording: &'e Recording, options: &'e RunOptions<'o>) -> Self {
        let (report, guards) = (RunReport::default(), Vec::new());
        Run { engine, recording, options, open: None, report, guards, section: None }
    }

    /// All of it.
    pub(crate) fn all(mut self) -> (Result<(), Error>, RunReport) {
        let mut halted: Option<Guard> = None;
        let done = loop {
            match self.from(halted.take()) {
                Ok(()) => break Ok(()),
                Err(Stop::Failed(error)) => break Err(error),
                // Each time behind the loop of the last time.
                Err(Stop::Halted(guard)) => halted = Some(guard),
            }
        };
        if let Some(slot) = self.open.take() {
            self.engine.submitter.done(slot);
        }
        (done, self.report)
    }

    /// From the start, or from the rest of a loop that was not done.
    fn from(&mut self, halted: Option<Guard>) -> Result<(), Stop> {
        let steps: &'e [Step] = &self.recording.steps;
        let mut next = 0;
        if let Some(guard) = halted {
            next = guard.step + 1;
            let name = |step: &Step| if let Step::Section(name) = step { Some(*name) } else { None };
            self.section = steps.iter().take(next).rev().find_map(name);
            if let Some(Step::Repeat(repeat)) = steps.get(guard.step) {
                self.may_go_on(repeat, guard.rounds)?;
                self.put_back()?;
                let batch = repeat.batch.saturating_mul(1 << guard.misses.min(MOST_DOUBLINGS));
                self.run_ahead(repeat, batch, Guard { misses: guard.misses + 1, ..guard })?;
            }
        }
        for (step, next) in steps.iter().zip(0..).skip(next) {
            match step {
                Step::Repeat(repeat) if repeat.ahead => {
                    let guard = Guard { step: next, name: repeat.name, rounds: 0, misses: 0 };
                    // Where one guess was too low those behind it likely are: and all that follows is sent again for each.
                    let more = if halted.is_some() && repeat.first > 0 { repeat.batch } else { 0 };
                    self.run_ahead(repeat, repeat.first.saturating_add(more), guard)?;
                }
                step => self.steps(std::slice::from_ref(step))?,
            }
        }
        self.flush()
    }

    /// Some rounds more of a loop that is not looked at before what is behind it.
    fn run_ahead(&mut self, repeat: &Repeat, rounds: u32, mut guard: Guard) -> Result<(), Stop> {
        let now = rounds.min(repeat.bound - guard.rounds);
        for _ in 0..now {
            self.steps(&repeat.body)?;
        }
        guard.rounds += now;
        self.guard(&repeat.counter, guard)
    }

    fn steps(&mut self, steps: &[Step]) -> Result<(), Stop> {
        for step in steps {
            self.make_room_to_stamp()?;
            let ahead = self.runs_ahead();
            match step {
                Step::Dispatch { kernel, size, arguments, touches } => {
                    let groups = match size {
                        Size::Indirect(groups) => Groups::In(groups.clone()),
                        Size::Direct(_, place) if ahead => Groups::In(self.size_at(*place)?),
                        Size::Direct(groups, _) => Groups::Are(*groups),
                    };
                    let mut uses: Vec<Use> = touches.iter().map(|touch| used(touch, Scope::Compute)).collect();
                    if let Groups::In(touch) = &groups {
                        uses.push(used(touch, Scope::Indirect));
                    }
                    self.dispatch(kernel, kernel.name, &groups, arguments, &uses)?;
                }
                Step::Fill { to, value, place } => match place {
                    Some(place) if ahead => self.fill_ahead(to, *value, *place)?,
                    _ => {
                        self.settle()?;
                        let commands = self.order(&[used(to, Scope::Transfer)])?;
                        self.stamp(commands, "fill", false);
                        let raw = &self.engine.submitter.device.raw;
                        let bytes = to.end - to.start;
                        // SAFETY: as in `dispatch`; views of words begin and end at multiples of 4 bytes.
                        unsafe { raw.cmd_fill_buffer(commands, to.buffer.memory.buffer, to.start, bytes, *value) };
                        self.stamp(commands, "fill", true);
                    }
                },
                Step::Copy { from, to, place } => match place {
                    Some(place) if ahead => self.copy_ahead(from, to, *place)?,
                    _ => {
                        self.settle()?;
                        let commands = self.order(&[used(from, Scope::Transfer), used(to, Scope::Transfer)])?;
                        self.stamp(commands, "copy", false);
                        self.copy(commands, from, to.buffer.memory.buffer, to.start);
                        self.stamp(commands, "copy", true);
                    }
                },
                Step::Read { from, to } => self.read(from, *to)?,
                Step::Section(name) => {
                    self.section = Some(name);
                    if let (Some(slot), Some(queries)) = (&self.open, &mut self.engine.queries) {
                        queries.section(slot.commands, self.section);
                    }
                }
                Step::Repeat(repeat) => self.repeat(repeat)?,
            }
        }
        Ok(())
    }

    /// A command that is known to run needs no guard; one that a guard cannot leave out waits for them.
    fn settle(&mut self) -> Result<(), Stop> {
        if self.runs_ahead() { self.flush() } else { Ok(()) }
    }

    pub(crate) fn make_room_to_stamp(&mut self) -> Result<(), Stop> {
        if self.options.timestamps && self.engine.queries.as_ref().is_some_and(Queries::is_full) {
            self.flush()?;
        }
        Ok(())
    }

    pub(crate) fn dispatch(
        &mut self,
        kernel: &KernelInner,
        name: &'static str,
        groups: &Groups,
        arguments: &[u8],
        uses: &[Use],
    ) -> Result<(), Stop> {
        let pipeline = kernel.pipeline()?;
        let commands = self.order(uses)?;
        self.stamp(commands, name, false);
        let raw = &self.engine.submitter.device.raw;
        let compute = vk::ShaderStageFlags::COMPUTE;
        // SAFETY: the command buffer is being recorded; kernel and buffers are of this device and are kept until the
        // device is done; workgroups are within its limits, sizes from a buffer too as kernels fold them.
        unsafe {
            raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
            raw.cmd_push_constants(commands, pipeline.layout, compute, 0, arguments);
            match groups {
                Groups::Are([x, y, z]) => raw.cmd_dispatch(commands, *x, *y, *z),
                Groups::In(groups) => raw.cmd_dispatch_indirect(commands, groups.buffer.memory.buffer, groups.start),
            }
        }
        self.stamp(commands, name, true);
        self.report.dispatches += 1;
        Ok(())
    }

    fn repeat(&mut self, repeat: &Repeat) -> Result<(), Stop> {
        let mut rounds = 0;
        loop {
            let batch = if rounds == 0 { repeat.first } else { repeat.batch };
            let now = batch.min(repeat.bound - rounds);
            for _ in 0..now {
                self.steps(&repeat.body)?;
            }
            rounds += now;
            self.read(&repeat.counter, repeat.read)?;
            self.flush()?;
            self.tell(repeat.name, rounds);
            if self.engine.word(repeat.read.first) == 0 {
                self.report.rounds.push((repeat.name, rounds));
                return Ok(());
            }
            self.may_go_on(repeat, rounds)?;
        }
    }

    fn tell(&self, name: &'static str, rounds: u32) {
        if let Some(tell) = self.options.progress {
            tell(name, rounds);
        }
    }

    /// Whether a loop that was not done after so many rounds goes on.
    fn may_go_on(&self, repeat: &Repeat, rounds: u32) -> Result<(), Error> {
        if rounds >= repeat.bound {
            return Err(Error::Bound { name: repeat.name, bound: repeat.bound });
        }
        if self.options.cancel.is_some_and(|cancel| cancel()) {
            return Err(Error::Cancelled);
        }
        Ok(())
    }

    pub(crate) fn read(&mut self, from: &Touch, to: ReadBack) -> Result<(), Error> {
        let commands = self.order(&[used(from, Scope::Transfer)])?;
        let Some(readback) = self.engine.readback.as_ref().map(|readback| readback.buffer) else { return Ok(()) };
        self.copy(commands, from, readback, u64::from(to.first) * 4);
        Ok(())
    }

    pub(crate) fn copy(&self, commands: vk::CommandBuffer, from: &Touch, to: vk::Buffer, at: u64) {
        let region = vk::BufferCopy::default().src_offset(from.start).dst_offset(at).size(from.end - from.start);
        let raw = &self.engine.submitter.device.raw;
        // SAFETY: the command buffer is being recorded; both ranges lie in their buffers, which the recording checked, do
        // not overlap, and are kept until the device is done.
        unsafe { raw.cmd_copy_buffer(commands, from.buffer.memory.buffer, to, &[region]) };
    }

    /// The open command buffer, behind whatever barrier these uses need.
    pub(crate) fn order(&mut self, uses: &[Use]) -> Result<vk::CommandBuffer, Error> {
        let commands = match &self.open {
            Some(slot) => slot.commands,
            None => {
                // A fresh command buffer begins behind everything before it.
                self.engine.hazards.clear();
                let commands = self.open.insert(self.engine.submitter.begin()?).commands;
                if let (Some(_), Some(queries)) = (self.section, &mut self.engine.queries) {
                    queries.section(commands, self.section);
                }
                commands
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

    /// Submits what is open and waits until it is done; then looks at the loops that were run ahead.
    fn flush(&mut self) -> Result<(), Stop> {
        let halt = self.read_halt()?;
        let Some(slot) = self.open.take() else { return Ok(()) };
        if let (Some(_), Some(queries)) = (self.section, &mut self.engine.queries) {
            queries.section(slot.commands, None);
        }
        host_reads(&self.engine.submitter.device.raw, slot.commands);
        let value = match self.engine.submitter.submit(&slot) {
            Ok(value) => value,
            Err(error) => {
                self.open = Some(slot);
                return Err(error.into());
            }
        };
        match self.engine.submitter.wait(value, self.options.timeout) {
            Ok(()) => self.engine.submitter.done(slot),
            Err(error) => {
                // The device may still be at it.
                let (queries, ahead) = (self.engine.queries.take(), self.engine.ahead.take());
                let mut used = Used { queries, ahead, ..Used::default() };
                held(&self.recording.steps, &mut used.buffers, &mut used.kernels);
                used.staging.extend(self.engine.readback.take());
                self.engine.submitter.park(slot, value, used);
                return Err(error.into());
            }
        }
        if let Some(queries) = &mut self.engine.queries {
            queries.collect(&mut self.report)?;
        }
        match halt {
            Some(place) => self.look(self.engine.word(place)),
            None => Ok(()),
        }
    }

    /// The loops before the one of this number are done; so are all, if it is zero.
    fn look(&mut self, halted: u32) -> Result<(), Stop> {
        for (guard, number) in std::mem::take(&mut self.guards).into_iter().zip(1..) {
            self.tell(guard.name, guard.rounds);
            if number == halted {
                return Err(Stop::Halted(guard));
            }
            self.report.rounds.push((guard.name, guard.rounds));
        }
        Ok(())
    }
}

/// How many workgroups.
pub(crate) enum Groups {
    Are([u32; 3]),
    In(Touch),
}

pub(crate) fn used(touch: &Touch, scope: Scope) -> Use {
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
