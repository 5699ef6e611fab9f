//! `cargo xtask bench constrained`: whole constrained triangulations on a Vulkan device, and what of it is for constraints.
//!
//! Input and output lie on the device, the result is in canonical order with its chains, in the numbering of the input, and
//! certified. The *constraint stage* is the walks, the insertion, and what the flips before and after take longer than those
//! of the same points without constraints.

use super::whole::{Bench, Input, OnDevice, Whole};
use super::{DeviceFacts, ms};
use polder::{Gpu, Pslg};
use polder_io::generate;
use serde::Serialize;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Seconds of programs for CPUs, measured before on the processor beside an NVIDIA H200, on one thread.
#[derive(Clone, Copy, Debug, Serialize)]
struct Peers {
    cgal: f64,
    spade: f64,
}

/// How long constraints are.
#[derive(Clone, Copy, Debug)]
enum Lengths {
    /// All, as in \[QCT\] 5.1.
    Any,
    /// A few edges.
    Short,
}

type Wanted = (usize, usize, Lengths, Option<Peers>);

const CASES: [Wanted; 2] = [
    (1_000_000, 100_000, Lengths::Any, Some(Peers { cgal: 1.37, spade: 1.18 })),
    (10_000_000, 1_000_000, Lengths::Any, Some(Peers { cgal: 17.2, spade: 17.3 })),
];
const FULL: Wanted = (10_000_000, 500_000, Lengths::Short, None);
const QUICK: [Wanted; 2] = [(3000, 300, Lengths::Any, None), (3000, 150, Lengths::Short, None)];

#[derive(Debug, Serialize)]
pub(crate) struct Results {
    device: DeviceFacts,
    runs: usize,
    /// Whether the results were held against the CPU backend.
    checked: bool,
    cases: Vec<Case>,
    /// Cases without figures, and why.
    failures: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Case {
    name: String,
    #[serde(flatten)]
    whole: Whole,
    /// The same points without constraints.
    points_alone: OnDevice,
    constraint_stage: ConstraintStage,
    peers: Option<Peers>,
}

/// Seconds for constraints.
#[derive(Clone, Copy, Debug, Serialize)]
struct ConstraintStage {
    walk: f64,
    insert: f64,
    /// Flips to the constrained Delaunay triangulation, less those to the Delaunay triangulation of the points.
    added_flips: f64,
    all: f64,
    /// Of the whole triangulation.
    share: f64,
}

pub(crate) fn run(
    runs: usize,
    (quick, full): (bool, bool),
    check: bool,
    file: Option<&Path>,
) -> Result<Results, String> {
    let mut on = super::OnDevice::open(runs).map_err(|error| error.to_string())?;
    let facts = on.facts().map_err(|error| error.to_string())?;
    let mut gpu = Gpu::on(&on.device).map_err(|error| error.to_string())?;
    let bench = Bench { runs, facts: facts.clone(), check };
    let mut wanted = match file {
        Some(_) => vec![],
        None if quick => QUICK.to_vec(),
        None => CASES.to_vec(),
    };
    wanted.extend(full.then_some(FULL));
    let (mut cases, mut failures) = (Vec::new(), Vec::new());
    let mut measure = |name: String, peers, pslg: Result<Pslg, String>| {
        eprintln!("{name}...");
        match pslg.map_err(Into::into).and_then(|pslg| case(&bench, &mut gpu, &name, &pslg, peers)) {
            Ok(case) => cases.push(case),
            Err(error) => {
                eprintln!("{name}: {error}");
                failures.push(format!("{name}: {error}"));
            }
        }
        gpu.release();
    };
    for (points, constraints, lengths, peers) in wanted {
        let start = Instant::now();
        let (name, pslg) = match lengths {
            Lengths::Any => ("constraints of all lengths", Ok(generate::segments(points, constraints, 1))),
            Lengths::Short => ("short constraints", short(points, constraints)),
        };
        eprintln!("made in {:.1} s", start.elapsed().as_secs_f64());
        measure(name.into(), peers, pslg);
    }
    if let Some(file) = file {
        measure(super::stem(file), None, super::read(file));
    }
    Ok(Results { device: facts, runs, checked: check, cases, failures })
}

fn case(bench: &Bench, gpu: &mut Gpu, name: &str, pslg: &Pslg, peers: Option<Peers>) -> Result<Case, Box<dyn Error>> {
    let whole = bench.whole(gpu, pslg)?;
    let input = Input::new(gpu, pslg)?.points_alone();
    let points_alone = bench.on_device(gpu, &input)?;
    let seconds = |on_device: &OnDevice, name: &str| {
        on_device.stages.iter().find(|stage| stage.name == name).map_or(0.0, |stage| stage.seconds)
    };
    let (walk, insert) = (seconds(&whole.on_device, "walk"), seconds(&whole.on_device, "constrain"));
    let flips = ["flip_points", "flip"].map(|stage| seconds(&whole.on_device, stage)).iter().sum::<f64>();
    let added_flips = flips - seconds(&points_alone, "flip");
    let all = walk + insert + added_flips;
    let constraint_stage = ConstraintStage { walk, insert, added_flips, all, share: all / whole.on_device.seconds };
    Ok(Case { name: name.to_owned(), whole, points_alone, constraint_stage, peers })
}

/// Uniform points, and constraints that join two of the same cell of a grid that has a cell for each constraint: they
/// do not cross, and are a few edges long.
fn short(points: usize, constraints: usize) -> Result<Pslg, String> {
    let points = generate::uniform(points, 1).into_parts().0;
    let side = constraints.isqrt() as f64;
    // The first point of each cell, until it has a second one.
    let mut waiting: HashMap<[u32; 2], Option<u32>> = HashMap::new();
    let mut pairs = Vec::with_capacity(constraints);
    for (i, p) in (0..).zip(&points) {
        match waiting.entry([p.x, p.y].map(|c| (c * side) as u32)) {
            Entry::Vacant(entry) => _ = entry.insert(Some(i)),
            Entry::Occupied(mut entry) => pairs.extend(entry.get_mut().take().map(|first| [first, i])),
        }
    }
    Pslg::new(points, pairs).map_err(|error| error.to_string())
}

impl Results {
    pub(crate) fn print(&self) {
        self.device.print();
        println!(
            "Milliseconds, median of {}; kernels: all stages by timestamps, input and output on the device",
            self.runs
        );
        println!(
            "constraint stage: walks, insertion, flips added; its share beside the less than 20 % of Qi, Cao and Tan"
        );
        println!("CGAL 5.5, spade 2.15: one thread, measured before on the processor beside an NVIDIA H200;");
        println!("gDel2D there inserted 500,000 short constraints among 10 million points in 6.1 ms");
        if !self.checked {
            println!("(not held against the CPU backend)");
        }
        println!(
            "{:<26} {:>9} {:>11} {:>8} {:>8} {:>5} {:>10} {:>6} {:>7} {:>7} {:>7} {:>8} {:>9} {:>8} {:>7} {:>7}",
            "input",
            "points",
            "constraints",
            "kernels",
            "clock",
            "waits",
            "constraint",
            "share",
            "walk",
            "insert",
            "flips",
            "B/point",
            "host-host",
            "CPU",
            "CGAL",
            "spade"
        );
        for Case { name, whole, constraint_stage: stage, peers, .. } in &self.cases {
            let option = |seconds: Option<f64>| seconds.map_or("-".into(), |seconds| format!("{:.0}", ms(seconds)));
            println!(
                "{:<26} {:>9} {:>11} {:>8.3} {:>8.3} {:>5} {:>10.3} {:>4.0} % {:>7.3} {:>7.3} {:>7.3} {:>8.0} {:>9.1} {:>8} {:>7} {:>7}",
                name,
                whole.points,
                whole.constraints,
                ms(whole.on_device.seconds),
                ms(whole.on_device.clock_seconds),
                whole.on_device.host_waits,
                ms(stage.all),
                100.0 * stage.share,
                ms(stage.walk),
                ms(stage.insert),
                ms(stage.added_flips),
                whole.bytes_a_point,
                ms(whole.host_to_host.seconds),
                option(whole.cpu_seconds),
                option(peers.map(|peers| peers.cgal)),
                option(peers.map(|peers| peers.spade)),
            );
        }
        self.failures.iter().for_each(|failure| println!("no figures: {failure}"));
        for case in &self.cases {
            case.whole.print(&case.name);
            println!("  the points alone: {:.3} ms", ms(case.points_alone.seconds));
        }
    }
}
