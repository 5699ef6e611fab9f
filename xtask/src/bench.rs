//! `cargo xtask bench`: builds the benchmarks optimized and runs them.

use crate::steps::{cargo, execute};
use std::path::Path;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// What the benchmarks take: which cases, `--quick`, `--points N`, `--runs K`, `--json`; `--help` tells all.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    rest: Vec<String>,
}

pub(crate) fn run(root: &Path, arguments: &Arguments) -> Result<(), String> {
    let mut command = cargo(root, &["run", "--release", "--quiet", "--package", "polder-benches", "--"]);
    command.args(&arguments.rest);
    execute(command)
}
