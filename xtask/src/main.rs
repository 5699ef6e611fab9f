//! The chores of the workspace: `cargo xtask ci`, `cargo xtask tidy`, `cargo xtask bench`,
//! `cargo xtask shaders`, `cargo xtask lavapipe`.
#![forbid(unsafe_code)]

mod bench;
mod ci;
mod lavapipe;
mod shaders;
mod steps;
mod tidy;

use clap::{Parser, Subcommand};
use std::path::Path;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "The chores of the polder workspace")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Everything that has to pass: format, clippy, documentation, tidy, tests.
    Ci(ci::Arguments),
    /// The rules of the workspace that no compiler knows: who may depend on whom, file sizes, what must be where.
    Tidy,
    /// Compiles the shaders and generates the typed arguments of every kernel.
    Shaders(shaders::Arguments),
    /// Prepares lavapipe and prints what to export: `eval "$(cargo xtask lavapipe)"`, then the Vulkan tests run by hand.
    Lavapipe,
    /// Builds the benchmarks optimized and runs them.
    Bench(bench::Arguments),
}

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let done = match Arguments::parse().chore {
        Chore::Ci(arguments) => ci::run(root, &arguments),
        Chore::Tidy => tidy::run(root),
        Chore::Shaders(arguments) => shaders::run(root, &arguments),
        Chore::Lavapipe => lavapipe::print(root),
        Chore::Bench(arguments) => bench::run(root, &arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("xtask: {why}");
            ExitCode::FAILURE
        }
    }
}
