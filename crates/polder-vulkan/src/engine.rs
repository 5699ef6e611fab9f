//! The engine runs recordings: the only place that turns them into commands of Vulkan.

use crate::Error;
use crate::ahead::Ahead;
use crate::device::Device;
use crate::hazards::Hazards;
use crate::memory::Allocated;
use crate::queries::Queries;
use crate::recording::{ReadBack, Recording};
use crate::run::Run;
use crate::submit::Submitter;
use crate::timing::Timings;
use crate::transfer::Staging;
use ash::vk;
use gpu_allocator::MemoryLocation;
use std::collections::BTreeMap;
use std::time::Duration;

/// How to run a recording.
pub struct RunOptions<'a> {
    /// Whether each command is timed.
    pub timestamps: bool,
    /// How long each wait for the device may take.
    pub timeout: Duration,
    /// Asked when a repeated body was looked at and is not done: true stops with [`Error::Cancelled`].
    pub cancel: Option<&'a dyn Fn() -> bool>,
    /// Told when a repeated body was looked at: its name, and its rounds so far.
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
    /// How long each section took, by its name: [`Recording::section`].
    pub sections: Timings,
    /// The timestamps of each section's commands, if asked for.
    pub by_section: BTreeMap<&'static str, Timings>,
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
    pub(crate) readback: Option<Allocated>,
    pub(crate) queries: Option<Queries>,
    pub(crate) ahead: Option<Ahead>,
    pub(crate) hazards: Hazards,
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
            ahead: None,
            hazards: Hazards::default(),
        })
    }

    /// Its device.
    pub fn device(&self) -> Device {
        Device { inner: self.submitter.device.clone(), pool: None }
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
        // One word more, for the loops that run ahead.
        self.make_room(recording.words + 1)?;
        if recording.runs_ahead() {
            let known = self.ahead.take().filter(|ahead| ahead.fits(recording));
            let device = Device { inner: self.submitter.device.clone(), pool: None };
            self.ahead = Some(known.map_or_else(|| Ahead::new(&device, recording), Ok)?);
        }
        let device = &self.submitter.device;
        device.pipelines.compile(device)?;
        let timed = options.timestamps || recording.has_sections();
        if timed && self.queries.is_none() && self.submitter.device.info.timestamps {
            self.queries = Some(Queries::new(&self.submitter.device)?);
        }
        let (submissions, waits) = (self.submitter.submissions, self.submitter.waits);
        let (done, mut report) = Run::new(self, recording, options).all();
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

    pub(crate) fn word(&self, place: u32) -> u32 {
        self.words(place + 1).last().copied().unwrap_or(0)
    }
}
