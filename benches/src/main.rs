//! What `cargo xtask bench` runs: polder against spade and delaunator in one run, on the same inputs.
//!
//! Every case runs all programs in turn, several times, and the median counts. Reading and copying the input and freeing
//! the result are not timed. Peak memory is measured in a process of its own for each case and program.
#![forbid(unsafe_code)]

mod inputs;
mod machine;
mod memory;
mod programs;
mod report;
mod timing;

use clap::{Parser, ValueEnum};
use inputs::Input;
use programs::Program;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask bench", about = "polder against spade and delaunator, side by side")]
struct Arguments {
    /// What to run; nothing means everything.
    #[arg(value_enum)]
    what: Vec<What>,
    /// The size of the cases in points.
    #[arg(long, default_value_t = 1_000_000)]
    points: usize,
    /// How many times each program runs on each case.
    #[arg(long, default_value_t = 5)]
    runs: usize,
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
        (arguments.points, arguments.runs) = (arguments.points.min(50_000), 1);
    }
    if let Some(case) = &arguments.peak_of {
        let [input, program] = case.as_slice() else { return Err("an input and a program are wanted".into()) };
        println!("{}", memory::of_this_process(Input::parse(input)?, arguments.points, Program::parse(program)?)?);
        return Ok(());
    }
    let wanted = |what| arguments.what.is_empty() || arguments.what.contains(&what);
    let programs = Program::all();
    let mut results = report::Results::new(arguments.points, arguments.runs);

    if wanted(What::Peers) {
        for input in Input::PEERS {
            results.peers.push(timing::compare(input, arguments.points, arguments.runs, &programs)?);
        }
    }
    if wanted(What::Degenerate) {
        for (input, share) in Input::DEGENERATE {
            let points = arguments.points / share;
            results.degenerate.push(timing::against_uniform(input, points, arguments.runs)?);
        }
    }
    if wanted(What::Memory) {
        for input in Input::PEERS {
            results.memory.push(memory::compare(input, arguments.points, &programs)?);
        }
    }
    if arguments.json {
        results.print_json()
    } else {
        results.print()
    }
    Ok(())
}
