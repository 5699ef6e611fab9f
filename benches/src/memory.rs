//! How much memory it takes at most, as Linux counts it.

use crate::inputs::Input;
use crate::programs::Program;
use serde::Serialize;
use std::fs;
use std::process::Command;

/// One input, and how many bytes a point each program held at most beyond the input.
#[derive(Debug, Serialize)]
pub(crate) struct Comparison {
    pub(crate) input: Input,
    pub(crate) points: usize,
    pub(crate) peaks: Vec<Peak>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Peak {
    pub(crate) program: String,
    pub(crate) bytes_a_point: f64,
}

/// Measures each program in a process of its own.
pub(crate) fn compare(input: Input, points: usize, programs: &[Program]) -> Result<Comparison, String> {
    eprintln!("{}: memory ({points} points)...", input.name());
    let pslg = input.make(points);
    let programs: Vec<_> = programs.iter().filter(|program| program.takes(&pslg)).collect();
    let count = pslg.points().len();
    drop(pslg);
    let mut peaks = Vec::new();
    for program in programs {
        let name = program.name();
        let this = std::env::current_exe().map_err(|error| error.to_string())?;
        let mut child = Command::new(this);
        child.args(["--points", &points.to_string(), "--peak-of", input.word(), &name]);
        let output = child.output().map_err(|error| error.to_string())?;
        let text = String::from_utf8_lossy(&output.stdout);
        let bytes: f64 = text.trim().parse().map_err(|_| String::from_utf8_lossy(&output.stderr).into_owned())?;
        peaks.push(Peak { program: name, bytes_a_point: bytes / count as f64 });
    }
    Ok(Comparison { input, points: count, peaks })
}

/// The most bytes that this process held while the program ran, less what it held at its start, less the input as that
/// program takes it. What the making of the input left behind unused counts against the program.
pub(crate) fn of_this_process(input: Input, points: usize, program: Program) -> Result<u64, String> {
    let at_start = status("VmRSS:")?;
    let pslg = input.make(points);
    let prepared = program.prepare(&pslg);
    let given = 16 * pslg.points().len() + 8 * pslg.constraints().len();
    let copied = match program {
        Program::Polder(_) => 0,
        Program::Spade | Program::Delaunator => 16 * pslg.points().len() + 16 * pslg.constraints().len(),
    };
    // Writing 5 sets the peak to what is held now.
    fs::write("/proc/self/clear_refs", "5").map_err(|error| format!("the peak cannot be reset: {error}"))?;
    let made = prepared.run()?.1;
    let peak = status("VmHWM:")?;
    drop((made, pslg));
    Ok(peak.saturating_sub(at_start + (given + copied) as u64))
}

/// A line of this process' status, in bytes.
fn status(name: &str) -> Result<u64, String> {
    let text = fs::read_to_string("/proc/self/status").map_err(|error| format!("no /proc here: {error}"))?;
    let line = text.lines().find_map(|line| line.strip_prefix(name));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kibibytes.map(|kibibytes| 1024 * kibibytes).ok_or_else(|| format!("no {name} in /proc/self/status"))
}
