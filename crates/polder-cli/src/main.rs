//! The command polder.
#![forbid(unsafe_code)]

mod args;
mod devices;
mod draw;
mod failure;
mod generate;
mod job;
mod triangulate;
mod verify;

use args::{Cli, Command};
use clap::Parser;
use failure::Failure;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let job = job::Job::begin(cli.quiet);
    let result = match &cli.command {
        Command::Triangulate(args) => triangulate::triangulate(&job, args),
        Command::Verify(args) => verify::verify(&job, args),
        Command::Digest(args) => triangulate::digest(&job, args),
        Command::Generate(args) => generate::generate(&job, args),
        Command::Draw(args) => draw::draw(&job, args),
        Command::Devices(args) => devices::devices(&job, args),
    };
    job.done();
    result.unwrap_or_else(|failure| {
        failure.tell(cli.error_format);
        ExitCode::from(failure.exit_code())
    })
}

/// Prints a line on standard output; a reader that has gone away is an error like any other.
fn print(line: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let written = writeln!(out, "{line}").and_then(|()| out.flush());
    written.map_err(|e| Failure::new("io", format!("standard output: {e}")))
}

/// A value as one line of JSON.
fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|e| Failure::new("internal", format!("a report is no JSON: {e}")))
}
