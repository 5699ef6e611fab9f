//! `cargo xtask ci`: everything that has to pass.

use crate::steps::{cargo, execute, step};
use crate::{lavapipe, shaders, tidy};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// The feature of the tests that need a Vulkan device.
const GPU: &str = "polder-tests/gpu-tests,polder-cli/gpu-tests";

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Also the tests on large inputs, which take long.
    #[arg(long)]
    long: bool,
}

pub(crate) fn run(root: &Path, arguments: &Arguments) -> Result<(), String> {
    let start = Instant::now();
    for (tool, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        let mut command = cargo(root, &[tool, "--version"]);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        execute(command).map_err(|_| {
            format!("{component} is not installed for this toolchain: `rustup component add {component}` installs it")
        })?;
    }

    step("format", || {
        execute(cargo(root, &["fmt", "--all", "--check"])).map_err(|why| format!("{why}; `cargo fmt --all` mends it"))
    })?;
    step("tidy", || tidy::run(root))?;
    step("shaders", || shaders::check(root))?;
    step("clippy", || {
        execute(cargo(
            root,
            &["clippy", "--workspace", "--all-targets", "--features", GPU, "--quiet", "--", "--deny", "warnings"],
        ))
    })?;
    step("documentation", || {
        let mut command = cargo(root, &["doc", "--workspace", "--no-deps", "--quiet"]);
        command.env("RUSTDOCFLAGS", "--deny warnings");
        execute(command)
    })?;
    step("tests", || execute(tests(root, &["--workspace"])))?;
    step("tests on a Vulkan device", || {
        let packages = ["--package", "polder-tests", "--package", "polder-cli"];
        let arguments = [&packages[..], &["--features", GPU, "--test", "vulkan_*", "--test", "*_gpu*"]].concat();
        let mut command = tests(root, &arguments);
        command.envs(lavapipe::prepare(root)?);
        execute(command)
    })?;
    if arguments.long {
        let ignored = ["--workspace", "--lib", "--bins", "--tests", "--", "--ignored"];
        step("long tests", || execute(tests(root, &ignored)))?;
    }
    println!("everything passed in {:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Runs tests; no snapshot is accepted or written anew.
fn tests(root: &Path, arguments: &[&str]) -> Command {
    let mut command = cargo(root, &["test", "--quiet"]);
    command.args(arguments).env("INSTA_UPDATE", "no");
    command
}
