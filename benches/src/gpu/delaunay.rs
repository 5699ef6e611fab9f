//! `cargo xtask bench delaunay`: whole triangulations on a Vulkan device, beside the CUDA program gDel2D.
//!
//! Input and output lie on the device; the result is in canonical order, in the numbering of the input, and certified. A
//! stage's time is that between two timestamps around all of it. Then the same from host memory to host memory.

use super::whole::{Bench, Whole};
use super::{DeviceFacts, OnDevice, ms};
use polder::{Gpu, Pslg};
use polder_io::generate;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

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
    gdel2d_seconds: Option<f64>,
    #[serde(flatten)]
    whole: Whole,
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
    let bench = Bench { runs, facts: facts.clone(), check };
    let mut measure = |name: String, gdel2d: Option<f64>, pslg: Result<Pslg, String>| {
        eprintln!("{name}...");
        match pslg.map_err(Into::into).and_then(|pslg| bench.whole(&mut gpu, &pslg)) {
            Ok(whole) => cases.push(Case { name, gdel2d_seconds: gdel2d.map(|ms| ms / 1e3), whole }),
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

impl Results {
    pub(crate) fn print(&self) {
        self.device.print();
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
            let Case { name, gdel2d_seconds, whole } = case;
            let ratio = gdel2d_seconds.map_or("-".into(), |other| format!("{:.2}", whole.on_device.seconds / other));
            println!(
                "{:<26} {:>11} {:>9.3} {:>9} {:>6} {:>9.3} {:>8} {:>7.0} {:>10.1} {:>9}",
                name,
                whole.points,
                ms(whole.on_device.seconds),
                option(*gdel2d_seconds),
                ratio,
                ms(whole.on_device.clock_seconds),
                whole.on_device.host_waits,
                whole.bytes_a_point,
                ms(whole.host_to_host.seconds),
                option(whole.cpu_seconds),
            );
        }
        self.failures.iter().for_each(|failure| println!("no figures: {failure}"));
        self.cases.iter().for_each(|case| case.whole.print(&case.name));
    }
}
