//! What `cargo xtask bench` runs: polder against spade and delaunator in one run, on the same inputs; and, asked for by
//! name, its stages on a Vulkan device.
//!
//! Every case runs all programs in turn, several times, and the median counts. Reading and copying the input and freeing
//! the result are not timed. Peak memory is measured in a process of its own for each case and program.
#![forbid(unsafe_code)]

mod figures;
mod gpu;
mod inputs;
mod machine;
mod memory;
mod programs;
mod report;
mod timing;

use clap::{Parser, ValueEnum};
use inputs::Input;
use programs::Program;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask bench", about = "polder against spade and delaunator, side by side")]
struct Arguments {
    /// What to run; nothing means everything that needs no Vulkan device.
    #[arg(value_enum)]
    what: Vec<What>,
    /// The size of the cases in points.
    #[arg(long, default_value_t = 1_000_000)]
    points: usize,
    /// How many times each program runs on each case: 5, and 10 on a Vulkan device, unless told.
    #[arg(long)]
    runs: Option<usize>,
    /// Does not hold results of a Vulkan device against the reference, which takes a while.
    #[arg(long)]
    unchecked: bool,
    /// Also the largest cases.
    #[arg(long)]
    full: bool,
    /// A .node, .poly or .pslg to run on a Vulkan device instead of the usual cases, or to take into the figures.
    #[arg(long)]
    file: Option<PathBuf>,
    /// The folder for the pictures of the figures.
    #[arg(long)]
    out: Option<PathBuf>,
    /// A small size and one run, to see that all works.
    #[arg(long)]
    quick: bool,
    /// One JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// Only measures the peak memory of one program on one input.
    #[arg(long, hide = true, num_args = 2, value_names = ["INPUT", "PROGRAM"])]
    peak_of: Option<Vec<String>>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Time against spade and delaunator.
    Peers,
    /// Degenerate inputs against uniform ones of the same size.
    Degenerate,
    /// Peak memory.
    Memory,
    /// Whole constrained triangulations on the Vulkan device that `POLDER_DEVICE` names, or the best one.
    Constrained,
    /// Whole triangulations on the Vulkan device that `POLDER_DEVICE` names, or the best one.
    Delaunay,
    /// Flips over the triangles that constraints run through, and how many of them each does; no device needed.
    Figures,
    /// The digital Voronoi diagram on the Vulkan device that `POLDER_DEVICE` names, or the best one.
    Voronoi,
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("bench: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: Arguments) -> Result<(), String> {
    if arguments.quick {
        arguments.points = arguments.points.min(50_000);
        arguments.runs = Some(1);
    }
    if let Some(case) = &arguments.peak_of {
        let [input, program] = case.as_slice() else { return Err("an input and a program are wanted".into()) };
        println!("{}", memory::of_this_process(Input::parse(input)?, arguments.points, Program::parse(program)?)?);
        return Ok(());
    }
    let wanted = |what| arguments.what.is_empty() || arguments.what.contains(&what);
    let runs = arguments.runs.unwrap_or(5);
    let programs = Program::all();
    let mut results = report::Results::new(arguments.points, runs);

    if wanted(What::Peers) {
        for input in Input::PEERS {
            results.peers.push(timing::compare(input, arguments.points, runs, &programs)?);
        }
    }
    if wanted(What::Degenerate) {
        for (input, share) in Input::DEGENERATE {
            let points = arguments.points / share;
            results.degenerate.push(timing::against_uniform(input, points, runs)?);
        }
    }
    if wanted(What::Memory) {
        for input in Input::PEERS {
            results.memory.push(memory::compare(input, arguments.points, &programs)?);
        }
    }
    if arguments.what.contains(&What::Delaunay) {
        let runs = arguments.runs.unwrap_or(10);
        let sizes = (arguments.quick, arguments.full);
        let file = arguments.file.as_deref();
        results.delaunay = Some(gpu::delaunay::run(runs, sizes, !arguments.unchecked, file)?);
    }
    if arguments.what.contains(&What::Constrained) {
        let (runs, sizes) = (arguments.runs.unwrap_or(10), (arguments.quick, arguments.full));
        let file = arguments.file.as_deref();
        results.constrained = Some(gpu::constrained::run(runs, sizes, !arguments.unchecked, file)?);
    }
    if arguments.what.contains(&What::Figures) {
        let (file, out) = (arguments.file.as_deref(), arguments.out.as_deref());
        results.figures = Some(figures::run(file, arguments.full, arguments.quick, out)?);
    }
    if arguments.what.contains(&What::Voronoi) {
        let runs = arguments.runs.unwrap_or(10);
        results.voronoi = Some(gpu::voronoi::run(runs, arguments.quick, !arguments.unchecked)?);
    }
    if arguments.json {
        results.print_json()
    } else {
        results.print()
    }
    Ok(())
}
