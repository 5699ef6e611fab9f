//! How long it takes.

use crate::inputs::Input;
use crate::machine::cores;
use crate::programs::{Made, Program};
use polder::verify;
use polder_mesh::Pslg;
use serde::Serialize;

/// One input, and how long each program took on it.
#[derive(Debug, Serialize)]
pub(crate) struct Comparison {
    pub(crate) input: Input,
    pub(crate) points: usize,
    pub(crate) constraints: usize,
    pub(crate) triangles: usize,
    pub(crate) times: Vec<Time>,
}

/// How long a program took.
#[derive(Debug, Serialize)]
pub(crate) struct Time {
    pub(crate) program: String,
    /// The median.
    pub(crate) seconds: f64,
    /// The median over spade's.
    pub(crate) to_spade: Option<f64>,
    /// Whether it made as many triangles as ours, which were verified.
    pub(crate) same_count: bool,
    pub(crate) runs: Vec<f64>,
}

/// How long ours took on an input and on a uniform one of the same size.
#[derive(Debug, Serialize)]
pub(crate) struct Ratio {
    pub(crate) input: Input,
    pub(crate) points: usize,
    pub(crate) threads: usize,
    pub(crate) seconds: f64,
    pub(crate) uniform_seconds: f64,
    pub(crate) ratio: f64,
}

/// Runs all programs in turn, `runs` times.
pub(crate) fn compare(input: Input, points: usize, runs: usize, programs: &[Program]) -> Result<Comparison, String> {
    eprintln!("{} ({points} points)...", input.name());
    let pslg = input.make(points);
    let programs: Vec<_> = programs.iter().filter(|program| program.takes(&pslg)).collect();
    let mut times = vec![Vec::new(); programs.len()];
    let mut counts = vec![0; programs.len()];
    for run in 0..runs.max(1) {
        for (i, program) in programs.iter().enumerate() {
            let (seconds, made) = program.prepare(&pslg).run()?;
            times[i].push(seconds);
            counts[i] = made.triangles();
            if run == 0 {
                verified(&pslg, &made)?;
            }
        }
    }
    let spade = programs.iter().position(|&&program| program == Program::Spade).map(|i| median(&times[i]));
    let times = programs.iter().zip(times).zip(&counts).map(|((program, runs), &count)| Time {
        program: program.name(),
        seconds: median(&runs),
        to_spade: spade.map(|spade| median(&runs) / spade),
        same_count: count == counts[0],
        runs,
    });
    let constraints = pslg.constraints().len();
    Ok(Comparison { input, points: pslg.points().len(), constraints, triangles: counts[0], times: times.collect() })
}

/// Runs ours on both inputs in turn, with one thread and with all.
pub(crate) fn against_uniform(input: Input, points: usize, runs: usize) -> Result<Vec<Ratio>, String> {
    eprintln!("{} against uniform ({points} points)...", input.name());
    let pslgs = [input, Input::Uniform].map(|input| input.make(points));
    let mut threads = vec![1, cores()];
    threads.dedup();
    let mut ratios = Vec::new();
    for threads in threads {
        let mut times = [Vec::new(), Vec::new()];
        for run in 0..runs.max(1) {
            for (pslg, times) in pslgs.iter().zip(&mut times) {
                let (seconds, made) = Program::Polder(threads).prepare(pslg).run()?;
                times.push(seconds);
                if run == 0 {
                    verified(pslg, &made)?;
                }
            }
        }
        let [seconds, uniform_seconds] = times.map(|times| median(&times));
        let ratio = seconds / uniform_seconds;
        ratios.push(Ratio { input, points: pslgs[0].points().len(), threads, seconds, uniform_seconds, ratio });
    }
    Ok(ratios)
}

/// Figures of a wrong result are worth nothing: ours must pass the checker.
fn verified(pslg: &Pslg, made: &Made) -> Result<(), String> {
    let Made::Polder(triangulation) = made else { return Ok(()) };
    let verdict = verify::check_triangulation(pslg, triangulation);
    if verdict.is_canonical() { Ok(()) } else { Err(verdict.to_string()) }
}

pub(crate) fn median(times: &[f64]) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    let middle = times.len() / 2;
    if times.len() % 2 == 1 { times[middle] } else { (times[middle - 1] + times[middle]) / 2.0 }
}
