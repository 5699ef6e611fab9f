//! How fast stage 4 is on a device: medians of ten, by timestamps, after the result was held against the reference.
//! `insert_speed [family:points]...`, say `clusters:1000000`; `POLDER_DEVICE` names the device. Starts are what stages 1 to
//! 3 of the reference leave.

mod speed;

use glam::DVec2;
use polder_dualize::gpu::insert::{Input, Stage};
use polder_dualize::reference::{self, ToInsert};
use polder_dualize::{Inserted, Shifted};
use polder_flip::gpu::{self as flips, Mesh};
use polder_vulkan::primitives::Copier;
use polder_vulkan::{Device, Engine, Recording, RunOptions};
use speed::{Failure, uploaded};
use std::time::Instant;

fn main() -> Result<(), Failure> {
    speed::each("uniform:20000", prepare, measure)
}

struct Case {
    title: String,
    positions: Vec<DVec2>,
    shifted: Shifted,
    sites: u32,
    new: ToInsert,
    expected: Inserted,
}

fn prepare(case: &str) -> Result<Case, Failure> {
    let pslg = speed::family(case)?;
    let phases = reference::triangulate(pslg.points(), &polder_voronoi::Options::default())?;
    let positions = phases.positions(pslg.points());
    let new = reference::points_to_insert(&phases.voronoi.diagram, &phases.voronoi.sites, &phases.shifted);
    let clock = Instant::now();
    let expected = reference::insert(phases.shifted.mesh.clone(), &positions, &new)?;
    let title = format!("{case}, {} to insert; reference {:.2} s", new.len(), clock.elapsed().as_secs_f64());
    Ok(Case { title, positions, sites: phases.voronoi.sites.count as u32, shifted: phases.shifted, new, expected })
}

fn measure(device: &Device, case: Case) -> Result<(), Failure> {
    let Case { title, positions, shifted, sites, new, expected } = &case;
    println!("{title}");
    let mut engine = Engine::new(device)?;
    let (stage, flips) = (Stage::new(device)?, flips::Stage::new(device)?);
    let mesh = Mesh::new(device, positions.len())?;
    let flip_buffers = flips.buffers(mesh.capacity())?;
    let buffers = stage.buffers(positions.len(), mesh.capacity())?;
    let points = uploaded(device, &mut engine, &new.points)?;
    let starts = uploaded(device, &mut engine, &new.starts)?;
    let sites = uploaded(device, &mut engine, &[*sites])?;
    let freed = uploaded(device, &mut engine, &shifted.freed)?;
    let input =
        Input { points: points.view(), starts: starts.view(), count: None, sites: sites.view(), freed: freed.view() };
    let mut recording = Recording::new(device);
    flips.record_start(&mut recording, &flip_buffers);
    let read = stage.record(&mut recording, &mesh, (&flips, &flip_buffers), &buffers, input)?;
    // A kept copy of the start, so that a run follows the one before at once, and the device stays at its clocks.
    let kept = Mesh::new(device, positions.len())?;
    kept.upload(&mut engine, &shifted.mesh, positions)?;
    mesh.upload(&mut engine, &shifted.mesh, positions)?;
    let copier = Copier::new(device)?;
    let mut restore = Recording::new(device);
    copier.record(&mut restore, kept.corners(), mesh.corners());
    copier.record(&mut restore, kept.slots(), mesh.slots());

    let counts = read.result(&engine.run(&recording, &RunOptions::default())?)?;
    let equal =
        mesh.download(&mut engine)? == expected.mesh && engine.download_vec(buffers.vertex_of())? == expected.vertex_of;
    let per_point = expected.steps as f64 / new.len().max(1) as f64;
    println!(
        "  equal: {equal}; {} rounds; {per_point:.1} steps a point; hull {}; flips {}",
        counts.rounds, counts.hull, counts.flips
    );
    speed::time(&mut engine, Some(&restore), &recording)
}
