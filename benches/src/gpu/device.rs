//! A device, and how long recordings take on it.

use polder_vulkan::primitives::Copier;
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions, RunReport};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// How long a recording runs before it is timed.
const WARM_UP: Duration = Duration::from_millis(700);
/// Bytes of the array that shows how fast memory is; less where there is little.
const COPIED: usize = 1 << 30;

/// What the figures were measured on.
#[derive(Debug, Serialize)]
pub(crate) struct DeviceFacts {
    pub(crate) name: String,
    pub(crate) driver: String,
    /// Bytes a second, read and written, of a copy.
    pub(crate) bandwidth: f64,
}

/// One kernel of a recording.
#[derive(Debug, Serialize)]
pub(crate) struct KernelTime {
    pub(crate) name: String,
    pub(crate) count: u64,
    /// The median of all its dispatches together.
    pub(crate) seconds: f64,
}

/// How long a recording takes.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    /// The median of all kernels together, by timestamps.
    pub(crate) seconds: f64,
    pub(crate) runs: Vec<f64>,
    /// The median by the clock, from handing over to the end of the last wait, without timestamps.
    pub(crate) clock_seconds: f64,
    pub(crate) waits: u32,
    pub(crate) dispatches: u32,
    /// What each loop took.
    pub(crate) rounds: Vec<(&'static str, u32)>,
    /// The slowest first.
    pub(crate) kernels: Vec<KernelTime>,
}

pub(crate) struct OnDevice {
    pub(crate) device: Device,
    pub(crate) engine: Engine,
    pub(crate) runs: usize,
}

impl OnDevice {
    pub(crate) fn open(runs: usize) -> Result<Self, polder_vulkan::Error> {
        let device = Device::open(&DeviceOptions::default())?;
        Ok(Self { engine: Engine::new(&device)?, device, runs: runs.max(1) })
    }

    pub(crate) fn facts(&mut self) -> Result<DeviceFacts, polder_vulkan::Error> {
        let bytes = COPIED.min(self.device.available_memory() as usize / 8);
        let buffers = [(); 2].map(|()| Buffer::<u32>::new(&self.device, "copied", bytes / 4));
        let [from, to] = buffers;
        let (from, to) = (from?, to?);
        let mut recording = Recording::new(&self.device);
        Copier::new(&self.device)?.record(&mut recording, from.view(), to.view());
        let copied = self.measure(|engine, options| engine.run(&recording, options))?;
        let info = self.device.info();
        let bandwidth = 2.0 * (bytes / 4 * 4) as f64 / copied.seconds;
        Ok(DeviceFacts { name: info.name.clone(), driver: info.driver.clone(), bandwidth })
    }

    /// Runs something until the card is awake, and then as often as wanted, with timestamps and without in turn.
    pub(crate) fn measure<E>(
        &mut self,
        mut work: impl FnMut(&mut Engine, &RunOptions<'_>) -> Result<RunReport, E>,
    ) -> Result<Measured, E> {
        let (plain, timed) = (RunOptions::default(), RunOptions { timestamps: true, ..RunOptions::default() });
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            work(&mut self.engine, &plain)?;
        }
        let (mut clock, mut runs) = (Vec::new(), Vec::new());
        let mut kernels: BTreeMap<&'static str, (u64, Vec<f64>)> = BTreeMap::new();
        let mut last = RunReport::default();
        for _ in 0..self.runs {
            let start = Instant::now();
            work(&mut self.engine, &plain)?;
            clock.push(start.elapsed().as_secs_f64());
            last = work(&mut self.engine, &timed)?;
            runs.push(last.timings.total().as_secs_f64());
            for (name, timing) in last.timings.iter() {
                let entry = kernels.entry(name).or_default();
                entry.0 = timing.count;
                entry.1.push(timing.total_ns as f64 / 1e9);
            }
        }
        let median = crate::timing::median;
        let mut kernels: Vec<KernelTime> = kernels
            .into_iter()
            .map(|(name, (count, times))| KernelTime { name: name.to_owned(), count, seconds: median(&times) })
            .collect();
        kernels.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        Ok(Measured {
            seconds: median(&runs),
            runs,
            clock_seconds: median(&clock),
            waits: last.waits,
            dispatches: last.dispatches,
            rounds: last.rounds,
            kernels,
        })
    }
}
