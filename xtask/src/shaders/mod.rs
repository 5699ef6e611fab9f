//! `cargo xtask shaders`: from `shaders-glsl/<stage>/<kernel>.comp` to `crates/polder-<stage>/spv/<kernel>.spv` and the
//! generated `crates/polder-<stage>/src/kernels.rs`, which holds typed arguments for every kernel.
//!
//! A kernel of which a line is `#ifndef NO_FLOAT64`, also in what it includes, is compiled twice: the second time to
//! `<kernel>.integers.spv`, with that macro defined, for devices without f64.
//!
//! Only compiling needs shaderc, and only then is it built (feature `shaders` of this package). What is checked with no
//! compiler at hand: that every source and include is the one that was compiled, and that `kernels.rs` is what the
//! committed SPIR-V says. With a compiler of the recorded version, also that it gives the committed bytes.

#[cfg(feature = "shaders")]
mod compile;
mod generate;
mod prepare;
mod reflect;
mod sources;

use crate::steps::execute;
use sources::{Stage, stages};
use std::path::Path;
use std::process::Command;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The stages to look at, `voronoi` for polder-voronoi; all of them if none is named.
    stages: Vec<String>,
    /// Writes nothing; fails where the committed files are not what the sources give.
    #[arg(long)]
    check: bool,
    /// With `--check`: looks for no compiler, and compares no bytes.
    #[arg(long, requires = "check")]
    no_compiler: bool,
    /// With `--check`: fails where there is no compiler.
    #[arg(long, requires = "check", conflicts_with = "no_compiler")]
    compiler: bool,
}

/// What a compiler is called in `kernels.rs`; absent where this binary was built without one.
#[cfg(feature = "shaders")]
fn compiler() -> Option<compile::Compiler> {
    Some(compile::Compiler::new(&prepare::version_in_use()))
}

pub(crate) fn run(root: &Path, arguments: &Arguments) -> Result<(), String> {
    #[cfg(feature = "shaders")]
    if !arguments.no_compiler {
        return with_compiler(root, arguments);
    }
    if arguments.check && (arguments.no_compiler || (!arguments.compiler && !prepare::at_hand(root))) {
        println!("shaders: no shader compiler at hand: sources and reflection are compared, bytes are not");
        return wanted(root, arguments)?.iter().try_for_each(|stage| check_without_compiler(root, stage));
    }
    again_with_compiler(root, arguments)
}

fn wanted(root: &Path, arguments: &Arguments) -> Result<Vec<Stage>, String> {
    let mut all = stages(root)?;
    if let Some(unknown) = arguments.stages.iter().find(|name| all.iter().all(|stage| stage.name != **name)) {
        return Err(format!("no kernels in shaders-glsl/{unknown}"));
    }
    all.retain(|stage| arguments.stages.is_empty() || arguments.stages.contains(&stage.name));
    Ok(all)
}

/// What is committed against its sources, and against the compiler where one is at hand.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    run(root, &Arguments { stages: Vec::new(), check: true, no_compiler: false, compiler: false })
}

/// Runs this chore once more, built with shaderc.
fn again_with_compiler(root: &Path, arguments: &Arguments) -> Result<(), String> {
    let found = prepare::prepare(root)?;
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    command.current_dir(root).args([
        "run",
        "--quiet",
        "--package",
        "xtask",
        "--features",
        found.feature,
        "--",
        "shaders",
    ]);
    command.args(&arguments.stages);
    if arguments.check {
        command.args(["--check", "--compiler"]);
    }
    for (name, value) in &found.environment {
        command.env(name, value);
    }
    execute(command)
}

#[cfg(feature = "shaders")]
fn with_compiler(root: &Path, arguments: &Arguments) -> Result<(), String> {
    let compiler = compiler().ok_or("built without shaderc")?;
    for stage in wanted(root, arguments)? {
        if arguments.check {
            check_without_compiler(root, &stage)?;
            check_bytes(root, &stage, &compiler)?;
        } else {
            write(root, &stage, &compiler)?;
        }
    }
    Ok(())
}

/// Compiles a stage whole, and removes what no source stands for any more.
#[cfg(feature = "shaders")]
fn write(root: &Path, stage: &Stage, compiler: &compile::Compiler) -> Result<(), String> {
    let folder = stage.spirv_folder(root);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut kernels = Vec::new();
    let mut modules = Vec::new();
    for kernel in &stage.kernels {
        let mut write = |name: String, second: bool| -> Result<reflect::Reflection, String> {
            let words = compiler.compile(root, kernel, second)?;
            let path = stage.spirv_file(root, &name);
            let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
            sources::write_if_changed(&path, &bytes)?;
            validate(&path)?;
            modules.push(name);
            reflect::reflect(&kernel.name, &words)
        };
        let reflection = write(kernel.name.clone(), false)?;
        let has_second = kernel.has_second(&reflection.capabilities);
        if has_second {
            reflection.check_second(&write(kernel.second(), true)?, &kernel.name)?;
        }
        kernels.push(generate::Kernel { source: kernel, reflection, has_second, compiler: compiler.name.clone() });
    }
    for name in stage.committed(root)? {
        if !modules.contains(&name) {
            let path = stage.spirv_file(root, &name);
            std::fs::remove_file(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        }
    }
    let text = generate::formatted(&generate::kernels(stage, &kernels)?)?;
    sources::write_if_changed(&stage.kernels_file(root), text.as_bytes())?;
    println!("shaders: {} kernels of polder-{}", stage.kernels.len(), stage.name);
    Ok(())
}

/// Sources, includes and reflection against what is committed.
fn check_without_compiler(root: &Path, stage: &Stage) -> Result<(), String> {
    let hint = "`cargo xtask shaders` mends it";
    let path = stage.kernels_file(root);
    let committed = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}; {hint}", path.display()))?;
    let compilers = generate::recorded_compilers(&committed);
    let mut names = Vec::new();
    let mut kernels = Vec::new();
    for kernel in &stage.kernels {
        let mut read = |name: String| -> Result<reflect::Reflection, String> {
            let path = stage.spirv_file(root, &name);
            validate(&path)?;
            names.push(name);
            reflect::reflect(&kernel.name, &sources::read_words(&path)?).map_err(|error| format!("{error}; {hint}"))
        };
        let reflection = read(kernel.name.clone())?;
        let has_second = kernel.has_second(&reflection.capabilities);
        if has_second {
            reflection.check_second(&read(kernel.second())?, &kernel.name)?;
        }
        let compiler = compilers.get(&kernel.name).cloned().unwrap_or_default();
        kernels.push(generate::Kernel { source: kernel, reflection, has_second, compiler });
    }
    names.sort();
    if stage.committed(root)? != names {
        return Err(format!("shaders-glsl/{0} and crates/polder-{0}/spv hold different kernels; {hint}", stage.name));
    }
    if generate::formatted(&generate::kernels(stage, &kernels)?)? != committed {
        return Err(format!(
            "{} is not what the sources and the committed SPIR-V of polder-{} give; {hint}",
            path.display(),
            stage.name
        ));
    }
    Ok(())
}

/// The bytes of kernels that were compiled by the compiler now at hand.
#[cfg(feature = "shaders")]
fn check_bytes(root: &Path, stage: &Stage, compiler: &compile::Compiler) -> Result<(), String> {
    let path = stage.kernels_file(root);
    let committed = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let compilers = generate::recorded_compilers(&committed);
    let mut other = 0;
    for kernel in &stage.kernels {
        if compilers.get(&kernel.name) != Some(&compiler.name) {
            other += 1;
            continue;
        }
        for (name, second) in [(kernel.name.clone(), false), (kernel.second(), true)] {
            let path = stage.spirv_file(root, &name);
            if (!second || path.exists()) && compiler.compile(root, kernel, second)? != sources::read_words(&path)? {
                return Err(format!("{} is not what {} makes of its source", path.display(), compiler.name));
            }
        }
    }
    let same = stage.kernels.len() - other;
    println!("shaders: polder-{}: {same} kernels compiled to the same bytes, {other} of another compiler", stage.name);
    Ok(())
}

/// spirv-val, where it is installed.
fn validate(path: &Path) -> Result<(), String> {
    let mut command = Command::new("spirv-val");
    command.args(["--target-env", "vulkan1.3"]).arg(path);
    match command.output() {
        Err(_) => Ok(()),
        Ok(done) if done.status.success() => Ok(()),
        Ok(done) => Err(format!(
            "spirv-val refuses {}: {}{}",
            path.display(),
            String::from_utf8_lossy(&done.stdout),
            String::from_utf8_lossy(&done.stderr)
        )),
    }
}
