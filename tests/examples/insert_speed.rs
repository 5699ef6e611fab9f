//! How fast stage 4 is on a device: medians of five, by timestamps, after the result was held against the reference.
//! `insert_speed [family:points]...`, say `clusters:1000000`; `POLDER_DEVICE` names the device. Starts are what stages 1 to
//! 3 of the reference leave.

use glam::DVec2;
use polder_dualize::gpu::insert::{Input, Stage};
use polder_dualize::reference::{self, ToInsert};
use polder_dualize::{Inserted, Shifted};
use polder_flip::gpu::{self as flips, Mesh};
use polder_vulkan::primitives::Copier;
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions};
use std::time::{Duration, Instant};

const RUNS: usize = 5;
/// A device that has slept runs at low clocks for a while.
const WARM: Duration = Duration::from_millis(700);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec!["uniform:20000".to_owned()] } else { arguments };
    // All at once: preparing takes longer than measuring.
    let mut threads = Vec::new();
    for case in cases {
        let (family, points) = case.split_once(':').ok_or("a case is family:points")?;
        let (family, points) = (family.to_owned(), points.parse()?);
        threads.push(std::thread::spawn(move || prepare(&family, points).map_err(|error| error.to_string())));
    }
    for thread in threads {
        measure(&device, &thread.join().map_err(|_| "a thread panicked")??)?;
    }
    Ok(())
}

struct Case {
    title: String,
    positions: Vec<DVec2>,
    shifted: Shifted,
    sites: u32,
    new: ToInsert,
    expected: Inserted,
}

fn prepare(family: &str, count: usize) -> Result<Case, Box<dyn std::error::Error>> {
    let families = polder_tests::point_families(count, 1);
    let (_, pslg) = families.into_iter().find(|(name, _)| *name == family).ok_or("no such family")?;
    let phases = reference::triangulate(pslg.points(), &polder_voronoi::Options::default())?;
    let positions = phases.positions(pslg.points());
    let new = reference::points_to_insert(&phases.voronoi.diagram, &phases.voronoi.sites, &phases.shifted);
    let clock = Instant::now();
    let expected = reference::insert(phases.shifted.mesh.clone(), &positions, &new)?;
    let title =
        format!("{family}, {count} points, {} to insert; reference {:.2} s", new.len(), clock.elapsed().as_secs_f64());
    Ok(Case { title, positions, sites: phases.voronoi.sites.count as u32, shifted: phases.shifted, new, expected })
}

fn measure(device: &Device, case: &Case) -> Result<(), Box<dyn std::error::Error>> {
    let Case { title, positions, shifted, sites, new, expected } = case;
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
    let read = stage.record(&mut recording, &mesh, (&flips, &flip_buffers), &buffers, input)?;
    // A kept copy of the start, so that a run follows the one before at once, and the device stays at its clocks.
    let kept = Mesh::new(device, positions.len())?;
    kept.upload(&mut engine, &shifted.mesh, positions)?;
    mesh.upload(&mut engine, &shifted.mesh, positions)?;
    let copier = Copier::new(device)?;
    let mut restore = Recording::new(device);
    copier.record(&mut restore, kept.corners(), mesh.corners());
    copier.record(&mut restore, kept.twins(), mesh.twins());
    copier.record(&mut restore, kept.slots(), mesh.slots());

    let counts = read.result(&engine.run(&recording, &RunOptions::default())?)?;
    let equal =
        mesh.download(&mut engine)? == expected.mesh && engine.download_vec(buffers.vertex_of())? == expected.vertex_of;
    let per_point = expected.steps as f64 / new.len().max(1) as f64;
    println!(
        "  equal: {equal}; {} rounds; {per_point:.1} steps a point; hull {}; flips {}",
        counts.rounds, counts.hull, counts.flips
    );
    let warm = Instant::now();
    while warm.elapsed() < WARM {
        engine.run(&restore, &RunOptions::default())?;
        engine.run(&recording, &RunOptions::default())?;
    }
    let [mut kernels, mut clock] = [Vec::new(), Vec::new()];
    let mut last = None;
    for run in 0..2 * RUNS {
        let timestamps = run % 2 == 1;
        engine.run(&restore, &RunOptions::default())?;
        let start = Instant::now();
        let report = engine.run(&recording, &RunOptions { timestamps, ..RunOptions::default() })?;
        if timestamps {
            kernels.push(report.timings.total());
            last = Some(report);
        } else {
            clock.push(start.elapsed());
        }
    }
    kernels.sort();
    clock.sort();
    let Some(report) = last else { return Ok(()) };
    println!(
        "  kernels {:.1} us, by clock {:.1} us, {} dispatches, {} waits",
        micros(kernels[RUNS / 2]),
        micros(clock[RUNS / 2]),
        report.dispatches,
        report.waits
    );
    let mut kernels: Vec<_> = report.timings.iter().collect();
    kernels.sort_by_key(|(_, timing)| std::cmp::Reverse(timing.total_ns));
    for (name, timing) in kernels.into_iter().take(16) {
        let us = |ns: u64| ns as f64 / 1e3;
        println!(
            "    {name:20} {:9.1} us in {:3}, longest {:.1}",
            us(timing.total_ns),
            timing.count,
            us(timing.longest_ns)
        );
    }
    Ok(())
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

fn uploaded<T: bytemuck::Pod>(
    device: &Device,
    engine: &mut Engine,
    data: &[T],
) -> Result<Buffer<T>, polder_vulkan::Error> {
    let buffer = Buffer::new(device, "input", data.len())?;
    engine.upload(buffer.view(), data)?;
    Ok(buffer)
}
