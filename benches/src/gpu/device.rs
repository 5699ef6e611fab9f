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
/// Kernels in a row that show what one costs at least.
const DISPATCHES: u32 = 200;

/// What the figures were measured on.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DeviceFacts {
    pub(crate) name: String,
    pub(crate) driver: String,
    /// Bytes a second, read and written, of a copy.
    pub(crate) bandwidth: f64,
    /// Seconds from the begin of a kernel that does next to nothing to that of the one behind it.
    pub(crate) dispatch: f64,
}

impl DeviceFacts {
    pub(crate) fn print(&self) {
        let Self { name, driver, bandwidth, dispatch } = self;
        let (terabytes, microseconds) = (bandwidth / 1e12, 1e6 * dispatch);
        println!("\n{name} ({driver})");
        println!("{terabytes:.2} TB/s read and written by a copy, {microseconds:.1} us for a kernel that does nothing");
    }
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
        let (name, driver) = (info.name.clone(), info.driver.clone());
        Ok(DeviceFacts { name, driver, bandwidth, dispatch: self.dispatch()? })
    }

    fn dispatch(&mut self) -> Result<f64, polder_vulkan::Error> {
        let words = [(); 2].map(|()| Buffer::<u32>::new(&self.device, "word", 1));
        let [from, to] = words;
        let (from, to) = (from?, to?);
        let mut recording = Recording::new(&self.device);
        recording.section("dispatches");
        let copier = Copier::new(&self.device)?;
        (0..DISPATCHES).for_each(|_| copier.record(&mut recording, from.view(), to.view()));
        let mut seconds = Vec::new();
        let start = Instant::now();
        while start.elapsed() < WARM_UP || seconds.len() < self.runs {
            let report = self.engine.run(&recording, &RunOptions::default())?;
            let all = report.sections.iter().map(|(_, timing)| timing.total_ns).sum::<u64>();
            seconds.push(all as f64 * 1e-9 / f64::from(DISPATCHES));
        }
        Ok(crate::timing::median(&seconds[seconds.len() - self.runs..]))
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
