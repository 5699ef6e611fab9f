//! A whole triangulation on a device, measured: by stage, by kernel, and from host memory to host memory.

use super::{DeviceFacts, ms};
use glam::DVec2;
use polder::{Backend, Gpu, KernelReport, Options, Place, Pslg, Report, StageReport, triangulate};
use polder_vulkan::Buffer;
use serde::Serialize;
use std::collections::BTreeMap;
use std::error::Error;
use std::time::{Duration, Instant};

/// How long a card works before it is timed.
const WARM_UP: Duration = Duration::from_millis(700);
/// More points than these are not held against the CPU backend, and go from host to host once.
const LARGE: usize = 20_000_000;

/// How to measure.
#[derive(Clone, Debug)]
pub(crate) struct Bench {
    pub(crate) runs: usize,
    pub(crate) facts: DeviceFacts,
    /// Whether results are held against the CPU backend.
    pub(crate) check: bool,
}

#[derive(Debug, Serialize)]
pub(crate) struct Whole {
    pub(crate) points: usize,
    pub(crate) constraints: usize,
    pub(crate) triangles: usize,
    /// The digest, if it was held against the CPU backend's.
    pub(crate) digest: Option<String>,
    #[serde(flatten)]
    pub(crate) on_device: OnDevice,
    /// Memory of the device that is held beyond the input, the output included.
    pub(crate) bytes_a_point: f64,
    /// From memory of the host to memory of the host.
    pub(crate) host_to_host: HostToHost,
    /// The CPU backend, with all cores, once.
    pub(crate) cpu_seconds: Option<f64>,
}

#[derive(Debug, Serialize)]
pub(crate) struct OnDevice {
    /// The median of all stages together, by timestamps.
    pub(crate) seconds: f64,
    pub(crate) runs: Vec<f64>,
    /// The median by the clock, all waits included.
    pub(crate) clock_seconds: f64,
    pub(crate) host_waits: u32,
    pub(crate) dispatches: u32,
    pub(crate) stages: Vec<Stage>,
    kernels: Vec<Kernel>,
    #[serde(skip)]
    triangles: usize,
}

#[derive(Debug, Serialize)]
pub(crate) struct Stage {
    pub(crate) name: &'static str,
    pub(crate) seconds: f64,
    pub(crate) counts: BTreeMap<&'static str, u64>,
    /// What has to be read and written once at least, and the share of the memory's speed that this makes.
    least_bytes: u64,
    of_bandwidth: f64,
    /// Kernels, those that find nothing to do included, and the share of the time that so many would take that do nothing.
    dispatches: u64,
    of_dispatches: f64,
    bound_by: Bound,
    /// The kernel that takes most of it, by timestamps around each, and its share.
    slowest: Option<(&'static str, f64)>,
}

/// What the most of a stage's time is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Bound {
    /// Bytes that have to be moved.
    Memory,
    /// Kernels that follow each other, however little they do.
    Rounds,
    /// Neither: memory is read here and there, and what to read next depends on what was read.
    Latency,
}

#[derive(Debug, Serialize)]
struct Kernel {
    stage: &'static str,
    name: &'static str,
    count: u64,
    seconds: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct HostToHost {
    pub(crate) seconds: f64,
    runs: Vec<f64>,
    upload: f64,
    /// Those on the device, by timestamps.
    stages: f64,
    download: f64,
}

impl Bench {
    pub(crate) fn whole(&self, gpu: &mut Gpu, pslg: &Pslg) -> Result<Whole, Box<dyn Error>> {
        let (mut cpu_seconds, mut digest) = (None, None);
        if self.check && pslg.points().len() <= LARGE {
            let start = Instant::now();
            let expected = triangulate(pslg, &Options::with_backend(Backend::Cpu))?.triangulation;
            cpu_seconds = Some(start.elapsed().as_secs_f64());
            let found = gpu.triangulate(pslg, &Options::default())?;
            if found.triangulation.digest() != expected.digest() || found.triangulation != expected {
                return Err("the device gives another result than the CPU backend".into());
            }
            if let Some(stage) = found.report.stages_on_cpu().next() {
                return Err(format!("{} ran on the CPU", stage.name).into());
            }
            digest = Some(expected.digest().to_string());
        }
        let host_to_host = self.host_to_host(gpu, pslg)?;
        gpu.release();
        let input = Input::new(gpu, pslg)?;
        let before = gpu.device().memory_use().used;
        let on_device = self.on_device(gpu, &input)?;
        let points = pslg.points().len();
        let held = gpu.device().memory_use().used - before;
        Ok(Whole {
            points,
            constraints: pslg.constraints().len(),
            triangles: on_device.triangles,
            digest,
            on_device,
            bytes_a_point: held as f64 / points as f64,
            host_to_host,
            cpu_seconds,
        })
    }

    /// Input and output lie on the device.
    pub(crate) fn on_device(&self, gpu: &mut Gpu, input: &Input) -> Result<OnDevice, Box<dyn Error>> {
        let plain = Options::default();
        let timed = Options { timestamps: true, ..Options::default() };
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            input.triangulate(gpu, &plain)?;
        }
        let (mut clock, mut reports) = (Vec::new(), Vec::new());
        for _ in 0..self.runs.max(1) {
            let start = Instant::now();
            let report = input.triangulate(gpu, &plain)?;
            clock.push(start.elapsed().as_secs_f64());
            reports.push(report);
        }
        let detailed = input.triangulate(gpu, &timed)?;
        let last = reports.last().ok_or("no run")?;
        let device = last.device.as_ref().ok_or("no device")?;
        let runs: Vec<f64> = reports.iter().map(all_stages).collect();
        let kernels: Vec<Kernel> = detailed.device.iter().flat_map(|device| &device.kernels).map(kernel_of).collect();
        let stages = last.stages.iter().map(|stage| self.stage(stage, &reports, &kernels, input));
        Ok(OnDevice {
            seconds: crate::timing::median(&runs),
            runs,
            clock_seconds: crate::timing::median(&clock),
            host_waits: device.host_waits,
            dispatches: device.dispatches,
            stages: stages.collect(),
            kernels,
            triangles: last.triangles,
        })
    }

    fn host_to_host(&self, gpu: &mut Gpu, pslg: &Pslg) -> Result<HostToHost, polder::Error> {
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            gpu.triangulate(pslg, &Options::default())?;
        }
        let (mut runs, mut stages, mut parts) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        for _ in 0..if pslg.points().len() > LARGE { 1 } else { self.runs.clamp(1, 5) } {
            let start = Instant::now();
            let output = gpu.triangulate(pslg, &Options::default())?;
            runs.push(start.elapsed().as_secs_f64());
            stages.push(all_stages(&output.report));
            for (name, part) in ["upload", "download"].iter().zip(&mut parts) {
                part.extend(output.report.stages.iter().find(|stage| stage.name == *name).map(|stage| stage.seconds));
            }
        }
        let median = crate::timing::median;
        let [upload, download] = parts.map(|part| median(&part));
        Ok(HostToHost { seconds: median(&runs), runs, upload, stages: median(&stages), download })
    }

    fn stage(&self, last: &StageReport, reports: &[Report], kernels: &[Kernel], input: &Input) -> Stage {
        let seconds = |report: &Report| report.stages.iter().find(|s| s.name == last.name).map_or(0.0, |s| s.seconds);
        let seconds = crate::timing::median(&reports.iter().map(seconds).collect::<Vec<_>>());
        let pixels = reports.iter().flat_map(|report| &report.stages).find_map(|s| s.counts.get("pixels").copied());
        let least_bytes = least_bytes(last, input, pixels.unwrap_or(0));
        let mine: Vec<&Kernel> = kernels.iter().filter(|kernel| kernel.stage == last.name).collect();
        let all: f64 = mine.iter().map(|kernel| kernel.seconds).sum();
        let slowest = mine.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let dispatches = mine.iter().map(|kernel| kernel.count).sum();
        let of_bandwidth = least_bytes as f64 / self.facts.bandwidth / seconds.max(1e-12);
        let of_dispatches = dispatches as f64 * self.facts.dispatch / seconds.max(1e-12);
        Stage {
            name: last.name,
            seconds,
            counts: last.counts.clone(),
            least_bytes,
            of_bandwidth,
            dispatches,
            of_dispatches,
            bound_by: match () {
                () if of_bandwidth >= 0.5 => Bound::Memory,
                () if of_dispatches >= 0.5 => Bound::Rounds,
                () => Bound::Latency,
            },
            slowest: slowest.map(|kernel| (kernel.name, kernel.seconds / all)),
        }
    }
}

/// An input on the device.
pub(crate) struct Input {
    points: Buffer<DVec2>,
    constraints: Option<Buffer<[u32; 2]>>,
}

impl Input {
    pub(crate) fn new(gpu: &mut Gpu, pslg: &Pslg) -> Result<Self, polder::Error> {
        let points = Buffer::new(gpu.device(), "points", pslg.points().len())?;
        gpu.engine().upload(points.view(), pslg.points())?;
        let mut constraints = None;
        if !pslg.constraints().is_empty() {
            let buffer = Buffer::new(gpu.device(), "constraints", pslg.constraints().len())?;
            gpu.engine().upload(buffer.view(), pslg.constraints())?;
            constraints = Some(buffer);
        }
        Ok(Self { points, constraints })
    }

    /// The same without constraints.
    pub(crate) fn points_alone(self) -> Self {
        Self { constraints: None, ..self }
    }

    fn constraints(&self) -> usize {
        self.constraints.as_ref().map_or(0, |buffer| buffer.view().len())
    }

    fn triangulate(&self, gpu: &mut Gpu, options: &Options) -> Result<Report, polder::Error> {
        let points = self.points.view();
        let made = match &self.constraints {
            None => gpu.triangulate_on_device(points, options)?,
            Some(constraints) => gpu.triangulate_constrained_on_device(points, constraints.view(), options)?,
        };
        Ok(made.report().clone())
    }
}

/// Seconds of all stages on the device.
fn all_stages(report: &Report) -> f64 {
    report.stages.iter().filter(|stage| stage.on == Place::Device).map(|stage| stage.seconds).sum()
}

fn kernel_of(kernel: &KernelReport) -> Kernel {
    Kernel { stage: kernel.stage, name: kernel.name, count: kernel.count, seconds: kernel.seconds }
}

/// What a stage cannot do without reading and writing: its input and output, each once. A mesh has two triangles a point,
/// 24 bytes each with its links.
fn least_bytes(stage: &StageReport, input: &Input, pixels: u64) -> u64 {
    let count = |name: &str| stage.counts.get(name).copied().unwrap_or(0);
    let (points, constraints) = (input.points.view().len() as u64, input.constraints() as u64);
    let mesh = 48 * points;
    match stage.name {
        "bounds" => 16 * points,
        // Points; the input index and pixel of each; colors.
        "voronoi" => (16 + 8) * points + 4 * pixels,
        "dualize" => 4 * pixels + 24 * count("triangles"),
        // Points and where they go; corners of all triangles.
        "shift" => (16 + 4 + 16) * points + mesh / 2,
        // For each point its triangle, and three in its place; for each flip two before and after, and four around.
        "insert" => (4 * 24 + 16) * count("inserted") + 8 * 24 * count("flips"),
        // Ends, their vertices and those of the chain; corners of all triangles, to find an edge at each vertex.
        "walk" => (8 + 8 + 8) * constraints + mesh / 2,
        // Ends; of each triangle that is run through corners, links, one position and an owner; flips.
        "constrain" => 8 * count("pieces") + (24 + 16 + 8) * count("intersections") + 8 * 24 * count("flips"),
        "flip" | "flip_points" => mesh + 16 * points + 8 * 24 * count("flips"),
        // The mesh, the numbers of points and of chains in, the same and representatives out.
        "canonical_order" => 2 * mesh + 12 * points + 2 * 8 * constraints,
        _ => 0,
    }
}

impl Whole {
    /// Everything of one case, below its name.
    pub(crate) fn print(&self, name: &str) {
        let Self { points, constraints, triangles, on_device, host_to_host: host, .. } = self;
        print!("\n{name}, {points} points, ");
        if *constraints > 0 {
            print!("{constraints} constraints, ");
        }
        println!("{triangles} triangles");
        if let Some(digest) = &self.digest {
            println!("  digest as that of the CPU backend: {digest}");
        }
        println!(
            "  {:<16} {:>9} {:>9} {:>6} {:>7} {:>6} {:>6} {:<8}  {:<26} counts",
            "stage", "ms", "least MB", "of it", "kernels", "of it", "rounds", "bound by", "slowest kernel"
        );
        for stage in &on_device.stages {
            let rounds = stage.counts.get("rounds").map_or("-".into(), u64::to_string);
            let slowest = stage.slowest.map_or("-".into(), |(name, share)| format!("{name} {:.0} %", 100.0 * share));
            let counts: Vec<String> = stage.counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
            println!(
                "  {:<16} {:>9.3} {:>9.1} {:>4.0} % {:>7} {:>4.0} % {:>6} {:<8}  {:<26} {}",
                stage.name,
                ms(stage.seconds),
                stage.least_bytes as f64 / 1e6,
                100.0 * stage.of_bandwidth,
                stage.dispatches,
                100.0 * stage.of_dispatches,
                rounds,
                format!("{:?}", stage.bound_by).to_lowercase(),
                slowest,
                counts.join(", ")
            );
        }
        let [all, upload, stages, download] = [host.seconds, host.upload, host.stages, host.download].map(ms);
        println!("  host to host {all:.1} ms: upload {upload:.1}, stages {stages:.1}, download {download:.1}");
        for kernel in on_device.kernels.iter().filter(|kernel| kernel.seconds > 0.01 * on_device.seconds) {
            let Kernel { stage, name, count, seconds } = kernel;
            println!("    {stage:<16} {name:<22} {count:>5} x {:>9.4} ms", ms(*seconds));
        }
    }
}
