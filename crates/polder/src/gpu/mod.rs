//! The Vulkan backend: every stage on one device, from points in its memory to a triangulation there.
//!
//! 1. Points go to the device, if they are not there. Their bounding box is found there, and the pixel grid fitted to it.
//! 2. All stages are one recording: digital Voronoi diagram, dualization, shift, insertion, flips, canonical order with its
//!    certificate. Loops run ahead, so that the host waits once if they take no more rounds than was guessed.
//! 3. What the stages found wrong is looked at; then the result is fetched, or lent where it lies.

mod auto;
mod held;
mod pipeline;
mod result;

pub use auto::AUTO_FROM;
pub(crate) use auto::{auto, vulkan};
pub use result::OnDevice;

use crate::report::{Place, Stopwatch};
use crate::{Error, KernelReport, Options, Output, Report, StageReport};
use held::{Found, Held};
use pipeline::Pipeline;
use polder_canonical::gpu::Line;
use polder_canonical::reference::Axis;
use polder_flip::gpu::Arithmetic;
use polder_mesh::{DVec2, Progress, Pslg};
use polder_voronoi::{GridMapping, Resolution};
use polder_vulkan::{Buffer, Device, DeviceKind, DeviceOptions, Engine, Recording, RunOptions, RunReport, View};
use std::sync::atomic::Ordering;

/// A Vulkan device with everything that triangulating on it needs: compiled kernels, and the memory of the last call, which
/// the next one of the same size uses again.
///
/// ```no_run
/// use polder::{Gpu, Options};
///
/// # fn main() -> Result<(), polder::Error> {
/// # let inputs: Vec<polder::Pslg> = Vec::new();
/// let mut gpu = Gpu::open(&Default::default())?;
/// for pslg in &inputs {
///     let output = gpu.triangulate(pslg, &Options::default())?;
///     assert!(output.report.stages_on_cpu().next().is_none());
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Gpu {
    device: Device,
    engine: Engine,
    arithmetic: Arithmetic,
    pipeline: Pipeline,
    input: Option<Buffer<DVec2>>,
    held: Option<Held>,
}

impl Gpu {
    /// Opens a device and compiles the kernels, or takes them from a cache on disk.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if there is no such device, or it lacks something.
    pub fn open(options: &DeviceOptions) -> Result<Self, Error> {
        Self::on(&Device::open(options)?)
    }

    /// On a device that is open already, which may be a caller's own ([`Device::borrow`]).
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if it lacks something.
    pub fn on(device: &Device) -> Result<Self, Error> {
        Self::with_arithmetic(device, Arithmetic::of(device)?)
    }

    /// With a given arithmetic for signs, instead of what the device's self-test allows: for tests. The result does not
    /// depend on it.
    ///
    /// # Errors
    ///
    /// As [`Gpu::on`].
    pub fn with_arithmetic(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let pipeline = Pipeline::new(device, arithmetic)?;
        device.compile()?;
        Ok(Self { device: device.clone(), engine: Engine::new(device)?, arithmetic, pipeline, input: None, held: None })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The engine, to bring points to buffers and fetch results from them.
    pub fn engine(&mut self) -> &mut Engine {
        &mut self.engine
    }

    /// Gives the memory of the last call back to the device.
    pub fn release(&mut self) {
        self.held = None;
        self.input = None;
    }

    /// Triangulates points in memory of the host, and fetches the result. Constraints are not for this backend yet.
    ///
    /// Backend and device of the options are not looked at, threads neither.
    ///
    /// # Errors
    ///
    /// - [`Error::Unsupported`] for constraints, or a grid that cannot be.
    /// - [`Error::OutOfMemory`] if memory does not suffice, which is found out before any work; [`Error::DeviceLost`].
    /// - [`Error::Cancelled`]; [`Error::BoundExceeded`] and [`Error::Internal`] are defects of polder.
    pub fn triangulate(&mut self, pslg: &Pslg, options: &Options) -> Result<Output, Error> {
        auto::refuse_constraints(pslg)?;
        let mut watch = Stopwatch::start();
        // Taken out, so that it can be lent to a method of all the rest.
        let mut input = match self.input.take() {
            Some(buffer) => buffer,
            None => Buffer::new(&self.device, "points", 0)?,
        };
        input.resize(pslg.points().len())?;
        self.engine.upload(input.view(), pslg.points())?;
        watch.stage_on(Place::Transfer, "upload", [("bytes", 16 * pslg.points().len() as u64)]);
        let made = std::thread::scope(|scope| {
            let room = scope.spawn(|| result::room(pslg.points().len()));
            let made = self.timed(input.view(), options, watch);
            made.and_then(|made| made.into_parts(room.join().unwrap_or_default()))
        });
        self.input = Some(input);
        let (triangulation, report) = made?;
        Ok(Output { triangulation, report })
    }

    /// Triangulates points that lie on the device, and leaves the result there. They must be finite; the first that is not
    /// is an error.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] for coordinates that are not finite; else as [`Gpu::triangulate`].
    pub fn triangulate_on_device(&mut self, points: View<'_, DVec2>, options: &Options) -> Result<OnDevice<'_>, Error> {
        self.timed(points, options, Stopwatch::start())
    }

    fn timed(
        &mut self,
        points: View<'_, DVec2>,
        options: &Options,
        mut watch: Stopwatch,
    ) -> Result<OnDevice<'_>, Error> {
        if points.is_empty() {
            self.held = None;
            let report = self.report(watch, 0, None, &[]);
            return Ok(OnDevice::new(&mut self.engine, None, report));
        }
        let mut runs = Vec::new();
        let mut recording = Recording::new(&self.device);
        recording.section("bounds");
        let read = self.pipeline.bounds.record(&mut recording, points)?;
        runs.push(run(&mut self.engine, &recording, options)?);
        let bounds = read.bounds(&runs[0])?;
        let resolution = match options.grid {
            Some(side) => Resolution::LongerSide(side).into(),
            None => polder_voronoi::Options::default(),
        };
        let mapping = GridMapping::fit_bounds(&bounds, points.len(), &resolution)?;
        self.make_room(points.len(), mapping.size())?;
        watch.skip();
        let held = self.held.as_ref().ok_or_else(|| internal("no memory was made"))?;

        let mut recording = Recording::new(&self.device);
        let reads = self.pipeline.record(&mut recording, &mapping, points, held)?;
        runs.push(run(&mut self.engine, &recording, options)?);
        let mut found = reads.found(&runs[1])?;
        if found.insert.on_a_line {
            // No triangle; duplicates have to be told nevertheless.
            let axis = if bounds.low().x == bounds.high().x { Axis::Y } else { Axis::X };
            let line = Line::new(&self.device, points.len())?;
            let mut recording = Recording::new(&self.device);
            recording.section("canonical_order");
            let read = line.record(&mut recording, points, axis, held.canonical.representatives())?;
            runs.push(run(&mut self.engine, &recording, options)?);
            found.line(read.vertices(&runs[2]));
        }
        watch.skip();
        let report = self.report(watch, points.len(), Some(&found), &runs);
        let held = self.held.as_ref().map(|held| (held, found));
        Ok(OnDevice::new(&mut self.engine, held, report))
    }

    /// Memory for so many points on a grid of this size; nothing is done if that is what there is.
    fn make_room(&mut self, points: usize, size: [u32; 2]) -> Result<(), Error> {
        if self.held.as_ref().is_none_or(|held| !held.fits(points, size)) {
            self.held = None;
            self.held = Some(Held::new(&self.device, &self.pipeline, points, size)?);
        }
        Ok(())
    }

    fn report(&self, watch: Stopwatch, points: usize, found: Option<&Found>, runs: &[RunReport]) -> Report {
        let info = self.device.info();
        let mut report = Report::started(watch);
        report.backend = "vulkan";
        report.why = "asked for".into();
        report.way = "digital Voronoi diagram, dualized, shifted, missing points inserted, flips, canonical order";
        report.device = Some(crate::DeviceReport {
            name: info.name.clone(),
            kind: match info.kind {
                DeviceKind::Discrete => "discrete",
                DeviceKind::Integrated => "integrated",
                DeviceKind::Virtual => "virtual",
                DeviceKind::Cpu => "cpu",
                _ => "other",
            },
            driver: info.driver.clone(),
            arithmetic: match self.arithmetic {
                Arithmetic::Filtered => "f64 first, then integers",
                Arithmetic::Integers => "integers",
            },
            opening_seconds: None,
            host_waits: runs.iter().map(|run| run.waits).sum(),
            dispatches: runs.iter().map(|run| run.dispatches).sum(),
            peak_bytes: self.device.memory_use().peak,
            kernels: runs.iter().flat_map(kernels).collect(),
        });
        let seconds = |name: &str| {
            let ns = runs.iter().filter_map(|run| run.sections.get(name)).map(|timing| timing.total_ns);
            ns.sum::<u64>() as f64 * 1e-9
        };
        let counts = found.map(Found::counts).unwrap_or_default();
        for (name, counts) in counts {
            let seconds = seconds(name);
            report.stages.push(StageReport { name, on: Place::Device, seconds, counts: counts.into_iter().collect() });
        }
        if let Some(found) = found {
            let vertices = found.canonical.vertices as usize;
            report.points.total = points;
            report.points.vertices = vertices;
            report.points.duplicates = points - vertices;
            report.triangles = found.canonical.triangles as usize;
        }
        report
    }
}

/// The kernels of a run, stage by stage.
fn kernels(run: &RunReport) -> Vec<KernelReport> {
    let mut kernels = Vec::new();
    for (&stage, timings) in &run.by_section {
        for (name, timing) in timings.iter() {
            kernels.push(KernelReport { stage, name, count: timing.count, seconds: timing.total_ns as f64 * 1e-9 });
        }
    }
    kernels
}

fn internal(what: &str) -> Error {
    Error::Internal { stage: "vulkan", what: what.to_owned() }
}

/// Runs a recording as the options say.
fn run(engine: &mut Engine, recording: &Recording, options: &Options) -> Result<RunReport, Error> {
    let cancel = || options.cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
    let tell = |stage: &'static str, rounds: u32| {
        if let Some(progress) = &options.progress {
            progress(Progress { stage, done: rounds.into(), total: rounds.into() });
        }
    };
    if cancel() {
        return Err(polder_vulkan::Error::Cancelled.into());
    }
    let run_options = RunOptions {
        timestamps: options.timestamps,
        cancel: Some(&cancel),
        progress: Some(&tell),
        ..RunOptions::default()
    };
    Ok(engine.run(recording, &run_options)?)
}
