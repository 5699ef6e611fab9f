//! How fast stage 5 is on a device: medians of ten, by timestamps, after the result was held against the reference.
//! `flip_speed [family:points]...`, say `uniform:1000000`; `POLDER_DEVICE` names the device. Starts are what stages 2 to 4
//! of the reference leave to be flipped.

mod speed;

use glam::DVec2;
use polder_dualize::reference as dualize;
use polder_flip::FlipReport;
use polder_flip::gpu::{Mesh, Stage, Tally};
use polder_flip::reference;
use polder_mesh::GhostMesh;
use polder_vulkan::primitives::Copier;
use polder_vulkan::{Device, Engine, Recording, RunOptions};
use speed::Failure;
use std::time::Instant;

fn main() -> Result<(), Failure> {
    speed::each("uniform:20000", prepare, measure)
}

struct Case {
    title: String,
    positions: Vec<DVec2>,
    start: GhostMesh,
    expected: GhostMesh,
    report: FlipReport,
}

/// What stages 1 to 4 leave, flipped.
fn prepare(case: &str) -> Result<Case, Failure> {
    let pslg = speed::family(case)?;
    let clock = Instant::now();
    let phases = dualize::triangulate(pslg.points(), &polder_voronoi::Options::default())?;
    let (positions, start) = (phases.positions(pslg.points()), phases.inserted.mesh);
    let prepared = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let mut expected = start.clone();
    let report = reference::flip(&mut expected, &positions)?;
    let (slots, reference) = (start.slots(), clock.elapsed().as_secs_f64());
    let title = format!("{case}, {slots} slots; start in {prepared:.1} s, reference {reference:.2} s");
    Ok(Case { title, positions, start, expected, report })
}

fn measure(device: &Device, case: Case) -> Result<(), Failure> {
    let Case { title, positions, start, expected, report: expected_report } = &case;
    println!("{title}: {expected_report}");
    let mut engine = Engine::new(device)?;
    let stage = Stage::new(device)?;
    let mesh = Mesh::with_slots(device, positions.len(), start.slots())?;
    let buffers = stage.buffers(start.slots())?;
    let tally = Tally::new(device)?;
    let mut recording = Recording::new(device);
    stage.record_start(&mut recording, &buffers);
    tally.record_clear(&mut recording);
    stage.record_flip(&mut recording, &mesh, &buffers, &tally)?;
    let read = tally.read(&mut recording);
    // A kept copy of the start, so that a run follows the one before at once, and the device stays at its clocks.
    let kept = Mesh::with_slots(device, positions.len(), start.slots())?;
    kept.upload(&mut engine, start, positions)?;
    let copier = Copier::new(device)?;
    let mut restore = Recording::new(device);
    copier.record(&mut restore, kept.corners(), mesh.corners());
    mesh.upload(&mut engine, start, positions)?;
    let report = engine.run(&recording, &RunOptions::default())?;
    let same = read.report(&report) == *expected_report && mesh.download(&mut engine)? == *expected;
    println!("  the same: {same}; {} bytes of scratch", stage.estimate(start.slots()).bytes());
    speed::time(&mut engine, Some(&restore), &recording)
}
