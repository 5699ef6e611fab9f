//! `cargo xtask bench delaunay`: whole triangulations on a Vulkan device, beside the CUDA program gDel2D.
//!
//! Input and output lie on the device; the result is in canonical order, in the numbering of the input, and certified. A
//! stage's time is that between two timestamps around all of it. Then the same from host memory to host memory.

use super::{DeviceFacts, OnDevice, ms};
use glam::DVec2;
use polder::{Backend, Gpu, Options, Place, Pslg, Report, StageReport, triangulate};
use polder_io::generate;
use polder_vulkan::Buffer;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// How long a card works before it is timed.
const WARM_UP: Duration = Duration::from_millis(700);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Uniform,
    Lattice,
    Gaussian,
    Clusters,
    ThinRing,
    ThinnerRing,
}

/// A shape, how many points, and the milliseconds of gDel2D's kernels, measured before on an NVIDIA H200.
const CASES: [(Shape, usize, Option<f64>); 7] = [
    (Shape::Uniform, 1_000_000, Some(13.6)),
    (Shape::Uniform, 10_000_000, Some(44.7)),
    (Shape::Lattice, 1_000_000, Some(132.0)),
    (Shape::Gaussian, 1_000_000, Some(15.4)),
    (Shape::Clusters, 1_000_000, None),
    (Shape::ThinRing, 1_000_000, Some(15.6)),
    (Shape::ThinnerRing, 1_000_000, None),
];
const FULL: (Shape, usize, Option<f64>) = (Shape::Uniform, 100_000_000, None);
/// More points than these are not held against the CPU backend, and go from host to host once.
const LARGE: usize = 20_000_000;
const QUICK: [(Shape, usize, Option<f64>); 2] = [(Shape::Uniform, 3000, None), (Shape::Lattice, 1600, None)];

impl Shape {
    fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Lattice => "lattice",
            Self::Gaussian => "gaussian",
            Self::Clusters => "100 clusters, sigma 1e-4",
            Self::ThinRing => "ring, 1e-3 thick",
            Self::ThinnerRing => "ring, 1e-9 thick",
        }
    }

    fn make(self, points: usize) -> Pslg {
        const SEED: u64 = 1;
        match self {
            Self::Uniform => generate::uniform(points, SEED),
            Self::Lattice => generate::lattice(points.isqrt(), points.isqrt()),
            Self::Gaussian => generate::gaussian(points, SEED),
            Self::Clusters => generate::clusters(points, 100, 1e-4, SEED),
            Self::ThinRing => generate::thin_ring(points, 1e-3, SEED),
            Self::ThinnerRing => generate::thin_ring(points, 1e-9, SEED),
        }
    }
}

#[derive(Debug, Serialize)]
pub(crate) struct Results {
    device: DeviceFacts,
    runs: usize,
    /// Whether the results were held against the CPU backend.
    checked: bool,
    /// Seconds to open the device and compile or load the kernels.
    opening: f64,
    cases: Vec<Case>,
    /// Cases without figures, and why.
    failures: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Case {
    name: String,
    points: usize,
    triangles: usize,
    /// The digest, if it was held against the CPU backend's.
    digest: Option<String>,
    /// The median of all stages together, by timestamps.
    seconds: f64,
    runs: Vec<f64>,
    /// The median by the clock, on the device, all waits included.
    clock_seconds: f64,
    host_waits: u32,
    dispatches: u32,
    bytes_a_point: f64,
    stages: Vec<Stage>,
    kernels: Vec<Kernel>,
    gdel2d_seconds: Option<f64>,
    /// From memory of the host to memory of the host.
    host_to_host: HostToHost,
    /// The CPU backend, with all cores, once.
    cpu_seconds: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Stage {
    name: &'static str,
    seconds: f64,
    counts: BTreeMap<&'static str, u64>,
    /// What has to be read and written once at least, and the share of the memory's speed that this makes.
    least_bytes: u64,
    of_bandwidth: f64,
    /// The kernel that takes most of it, by timestamps around each, and its share.
    slowest: Option<(&'static str, f64)>,
}

#[derive(Debug, Serialize)]
struct Kernel {
    stage: &'static str,
    name: &'static str,
    count: u64,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct HostToHost {
    seconds: f64,
    runs: Vec<f64>,
    upload: f64,
    download: f64,
}

pub(crate) fn run(
    runs: usize,
    (quick, full): (bool, bool),
    check: bool,
    file: Option<&Path>,
) -> Result<Results, String> {
    let mut on = OnDevice::open(runs).map_err(|error| error.to_string())?;
    let facts = on.facts().map_err(|error| error.to_string())?;
    let start = Instant::now();
    let mut gpu = Gpu::on(&on.device).map_err(|error| error.to_string())?;
    let opening = start.elapsed().as_secs_f64();
    let mut wanted = match file {
        Some(_) => vec![],
        None if quick => QUICK.to_vec(),
        None => CASES.to_vec(),
    };
    wanted.extend(full.then_some(FULL));
    let (mut cases, mut failures) = (Vec::new(), Vec::new());
    let mut measure = |name: String, gdel2d, pslg: Result<Pslg, String>| {
        eprintln!("{name}...");
        let bench = Bench { name: name.clone(), gdel2d, runs: runs.max(1), bandwidth: facts.bandwidth, check };
        match pslg.map_err(Into::into).and_then(|pslg| bench.case(&mut gpu, &pslg)) {
            Ok(case) => cases.push(case),
            Err(error) => {
                eprintln!("{name}: {error}");
                failures.push(format!("{name}: {error}"));
            }
        }
        gpu.release();
    };
    for (shape, points, gdel2d) in wanted {
        measure(shape.name().into(), gdel2d, Ok(shape.make(points)));
    }
    if let Some(file) = file {
        let points = super::read(file).map(|pslg| pslg.into_parts().0);
        let pslg = points.and_then(|points| Pslg::new(points, vec![]).map_err(|error| error.to_string()));
        measure(super::stem(file), None, pslg);
    }
    Ok(Results { device: facts, runs, checked: check, opening, cases, failures })
}

struct Bench {
    name: String,
    gdel2d: Option<f64>,
    runs: usize,
    bandwidth: f64,
    check: bool,
}

impl Bench {
    fn case(&self, gpu: &mut Gpu, pslg: &Pslg) -> Result<Case, Box<dyn std::error::Error>> {
        let points: &[DVec2] = pslg.points();
        let plain = Options::default();
        let (mut cpu_seconds, mut digest) = (None, None);
        if self.check && points.len() <= LARGE {
            let start = Instant::now();
            let expected = triangulate(pslg, &Options::with_backend(Backend::Cpu))?.triangulation;
            cpu_seconds = Some(start.elapsed().as_secs_f64());
            let found = gpu.triangulate(pslg, &plain)?;
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

        let input = Buffer::new(gpu.device(), "points", points.len())?;
        gpu.engine().upload(input.view(), points)?;
        let timed = Options { timestamps: true, ..Options::default() };
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            gpu.triangulate_on_device(input.view(), &plain)?;
        }
        let (mut clock, mut reports) = (Vec::new(), Vec::new());
        for _ in 0..self.runs {
            let start = Instant::now();
            let made = gpu.triangulate_on_device(input.view(), &plain)?;
            clock.push(start.elapsed().as_secs_f64());
            reports.push(made.report().clone());
        }
        let detailed = gpu.triangulate_on_device(input.view(), &timed)?.report().clone();
        let last = reports.last().ok_or("no run")?.clone();
        let device = last.device.clone().ok_or("no device")?;
        let on_device = |report: &Report| {
            let stages = report.stages.iter().filter(|stage| stage.on == Place::Device);
            stages.map(|stage| stage.seconds).sum::<f64>()
        };
        let runs: Vec<f64> = reports.iter().map(on_device).collect();
        let kernels: Vec<Kernel> = detailed.device.iter().flat_map(|device| &device.kernels).map(kernel_of).collect();
        let stages = last.stages.iter().map(|stage| self.stage(stage, &reports, &kernels, points.len()));
        Ok(Case {
            name: self.name.clone(),
            points: points.len(),
            triangles: last.triangles,
            digest,
            seconds: crate::timing::median(&runs),
            runs,
            clock_seconds: crate::timing::median(&clock),
            host_waits: device.host_waits,
            dispatches: device.dispatches,
            bytes_a_point: (gpu.device().memory_use().used - 16 * points.len() as u64) as f64 / points.len() as f64,
            stages: stages.collect(),
            kernels,
            gdel2d_seconds: self.gdel2d.map(|ms| ms / 1e3),
            host_to_host,
            cpu_seconds,
        })
    }

    fn host_to_host(&self, gpu: &mut Gpu, pslg: &Pslg) -> Result<HostToHost, polder::Error> {
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            gpu.triangulate(pslg, &Options::default())?;
        }
        let (mut runs, mut parts) = (Vec::new(), [Vec::new(), Vec::new()]);
        for _ in 0..if pslg.points().len() > LARGE { 1 } else { self.runs.min(5) } {
            let start = Instant::now();
            let output = gpu.triangulate(pslg, &Options::default())?;
            runs.push(start.elapsed().as_secs_f64());
            for (name, part) in ["upload", "download"].iter().zip(&mut parts) {
                part.extend(output.report.stages.iter().find(|stage| stage.name == *name).map(|stage| stage.seconds));
            }
        }
        let median = crate::timing::median;
        Ok(HostToHost { seconds: median(&runs), runs, upload: median(&parts[0]), download: median(&parts[1]) })
    }

    fn stage(&self, last: &StageReport, reports: &[Report], kernels: &[Kernel], points: usize) -> Stage {
        let seconds = |report: &Report| report.stages.iter().find(|s| s.name == last.name).map_or(0.0, |s| s.seconds);
        let seconds = crate::timing::median(&reports.iter().map(seconds).collect::<Vec<_>>());
        let pixels = reports.iter().flat_map(|report| &report.stages).find_map(|s| s.counts.get("pixels").copied());
        let least_bytes = least_bytes(last, points as u64, pixels.unwrap_or(0));
        let mine: Vec<&Kernel> = kernels.iter().filter(|kernel| kernel.stage == last.name).collect();
        let all: f64 = mine.iter().map(|kernel| kernel.seconds).sum();
        let slowest = mine.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds));
        Stage {
            name: last.name,
            seconds,
            counts: last.counts.clone(),
            least_bytes,
            of_bandwidth: least_bytes as f64 / self.bandwidth / seconds.max(1e-12),
            slowest: slowest.map(|kernel| (kernel.name, kernel.seconds / all)),
        }
    }
}

fn kernel_of(kernel: &polder::KernelReport) -> Kernel {
    Kernel { stage: kernel.stage, name: kernel.name, count: kernel.count, seconds: kernel.seconds }
}

/// What a stage cannot do without reading and writing: its input and output, each once. A mesh has two triangles a point,
/// 24 bytes each with its links.
fn least_bytes(stage: &StageReport, points: u64, pixels: u64) -> u64 {
    let count = |name: &str| stage.counts.get(name).copied().unwrap_or(0);
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
        "flip" => mesh + 16 * points + 8 * 24 * count("flips"),
        // The mesh and the numbers of points in, the same and their representatives out.
        "canonical_order" => 2 * mesh + 12 * points,
        _ => 0,
    }
}

impl Results {
    pub(crate) fn print(&self) {
        let DeviceFacts { name, driver, bandwidth } = &self.device;
        println!("\n{name} ({driver}), {:.2} TB/s read and written by a copy", bandwidth / 1e12);
        println!(
            "Milliseconds, median of {}; kernels: all stages by timestamps, input and output on the device",
            self.runs
        );
        println!("gDel2D: tuned CUDA, kernels alone, no canonical order, measured before on an NVIDIA H200");
        println!("opening the device and loading the kernels: {:.0} ms", ms(self.opening));
        if !self.checked {
            println!("(not held against the CPU backend)");
        }
        println!(
            "{:<26} {:>11} {:>9} {:>9} {:>6} {:>9} {:>8} {:>7} {:>10} {:>9}",
            "points", "", "kernels", "gDel2D", "ratio", "clock", "waits", "B/point", "host-host", "CPU"
        );
        for case in &self.cases {
            let option = |seconds: Option<f64>| seconds.map_or("-".into(), |seconds| format!("{:.1}", ms(seconds)));
            let ratio = case.gdel2d_seconds.map_or("-".into(), |other| format!("{:.2}", case.seconds / other));
            println!(
                "{:<26} {:>11} {:>9.3} {:>9} {:>6} {:>9.3} {:>8} {:>7.0} {:>10.1} {:>9}",
                case.name,
                case.points,
                ms(case.seconds),
                option(case.gdel2d_seconds),
                ratio,
                ms(case.clock_seconds),
                case.host_waits,
                case.bytes_a_point,
                ms(case.host_to_host.seconds),
                option(case.cpu_seconds),
            );
        }
        self.failures.iter().for_each(|failure| println!("no figures: {failure}"));
        for case in &self.cases {
            println!("\n{}, {} points, {} triangles", case.name, case.points, case.triangles);
            if let Some(digest) = &case.digest {
                println!("  digest as that of the CPU backend: {digest}");
            }
            println!(
                "  {:<16} {:>9} {:>10} {:>6} {:>6}  {:<28} counts",
                "stage", "ms", "least MB", "of it", "rounds", "slowest kernel"
            );
            for stage in &case.stages {
                let rounds = stage.counts.get("rounds").map_or("-".into(), u64::to_string);
                let slowest =
                    stage.slowest.map_or("-".into(), |(name, share)| format!("{name} {:.0} %", 100.0 * share));
                let counts: Vec<String> = stage.counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
                println!(
                    "  {:<16} {:>9.3} {:>10.1} {:>4.0} % {:>6}  {:<28} {}",
                    stage.name,
                    ms(stage.seconds),
                    stage.least_bytes as f64 / 1e6,
                    100.0 * stage.of_bandwidth,
                    rounds,
                    slowest,
                    counts.join(", ")
                );
            }
            let host = &case.host_to_host;
            println!(
                "  host to host {:.1} ms: upload {:.1}, download {:.1}",
                ms(host.seconds),
                ms(host.upload),
                ms(host.download)
            );
            for kernel in case.kernels.iter().filter(|kernel| kernel.seconds > 0.01 * case.seconds) {
                println!(
                    "    {:<16} {:<22} {:>5} x {:>9.4} ms",
                    kernel.stage,
                    kernel.name,
                    kernel.count,
                    ms(kernel.seconds)
                );
            }
        }
    }
}
