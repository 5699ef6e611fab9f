//! How fast stage 5 is on a device: medians of ten, by timestamps, after the result was held against the reference.
//! `flip_speed [family:points]...`, say `uniform:1000000`; `POLDER_DEVICE` names the device. Starts are what stages 2 to 4
//! of the reference leave to be flipped.

use glam::DVec2;
use polder_dualize::reference as dualize;
use polder_flip::FlipReport;
use polder_flip::gpu::{Mesh, Stage, Tally};
use polder_flip::reference;
use polder_mesh::GhostMesh;
use polder_vulkan::primitives::Copier;
use polder_vulkan::{Device, DeviceOptions, Engine, Recording, RunOptions, Timings};
use std::time::{Duration, Instant};

const RUNS: usize = 10;
/// For so long it runs unmeasured before.
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
    start: GhostMesh,
    expected: GhostMesh,
    report: FlipReport,
}

fn prepare(family: &str, count: usize) -> Result<Case, Box<dyn std::error::Error>> {
    let clock = Instant::now();
    let (positions, start) = start_of(family, count)?;
    let prepared = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let mut expected = start.clone();
    let report = reference::flip(&mut expected, &positions)?;
    let (slots, reference) = (start.slots(), clock.elapsed().as_secs_f64());
    let title =
        format!("{family}, {count} points, {slots} slots; start in {prepared:.1} s, reference {reference:.2} s");
    Ok(Case { title, positions, start, expected, report })
}

/// Positions and the mesh of stages 1 to 4.
fn start_of(family: &str, count: usize) -> Result<(Vec<DVec2>, GhostMesh), Box<dyn std::error::Error>> {
    let families = polder_tests::point_families(count, 1);
    let (_, pslg) = families.into_iter().find(|(name, _)| *name == family).ok_or("no such family")?;
    let options = polder_voronoi::Options::default();
    let voronoi = polder_voronoi::reference::diagram(pslg.points(), &options)?;
    let sites = &voronoi.sites;
    let positions: Vec<DVec2> = sites.order.iter().map(|&i| pslg.points()[i as usize]).collect();
    let centers: Vec<DVec2> =
        sites.pixels[..sites.count].iter().map(|pixel| voronoi.mapping.center(pixel.map(u32::from))).collect();
    let dualized = dualize::dualize(&voronoi.diagram, sites)?;
    let shifted = dualize::shift(dualized.mesh, &centers, &positions)?;
    let new = dualize::points_to_insert(&voronoi.diagram, sites, &shifted);
    let inserted = dualize::insert(shifted.mesh, &positions, &new)?;
    Ok((positions, inserted.mesh))
}

fn measure(device: &Device, case: &Case) -> Result<(), Box<dyn std::error::Error>> {
    let Case { title, positions, start, expected, report: expected_report } = case;
    println!("{title}: {expected_report}");
    let mut engine = Engine::new(device)?;
    let stage = Stage::new(device)?;
    let mesh = Mesh::with_slots(device, positions.len(), start.slots())?;
    let buffers = stage.buffers(start.slots())?;
    let tally = Tally::new(device)?;
    let mut recording = Recording::new(device);
    tally.record_clear(&mut recording);
    stage.record_flip(&mut recording, &mesh, &buffers, &tally)?;
    let read = tally.read(&mut recording);
    let (mut times, mut kernels, mut last, mut waits) = (Vec::new(), Vec::new(), Timings::default(), 0);
    // A kept copy of the start, so that a run follows the one before at once, and the device stays at its clocks.
    let kept = Mesh::with_slots(device, positions.len(), start.slots())?;
    kept.upload(&mut engine, start, positions)?;
    let copier = Copier::new(device)?;
    let mut restore = Recording::new(device);
    copier.record(&mut restore, kept.corners(), mesh.corners());
    copier.record(&mut restore, kept.twins(), mesh.twins());
    mesh.upload(&mut engine, start, positions)?;
    let warm = Instant::now();
    let mut run = 0;
    while run < 2 * RUNS {
        engine.run(&restore, &RunOptions::default())?;
        if run == 1 && warm.elapsed() < WARM {
            engine.run(&recording, &RunOptions::default())?;
            continue;
        }
        let timestamps = run >= RUNS;
        let clock = Instant::now();
        let report = engine.run(&recording, &RunOptions { timestamps, ..RunOptions::default() })?;
        times.push(clock.elapsed());
        if timestamps {
            kernels.push(report.timings.total());
        }
        waits = report.waits;
        if run == 0 {
            let same = read.report(&report) == *expected_report && mesh.download(&mut engine)? == *expected;
            println!("  the same: {same} ({})", read.report(&report));
        }
        last = report.timings;
        run += 1;
    }
    times.truncate(RUNS);
    times.sort();
    kernels.sort();
    let ms = |time: &Duration| time.as_secs_f64() * 1e3;
    println!(
        "  {:.3} ms by kernels, {:.3} ms with all {waits} waits; {} bytes of scratch",
        ms(&kernels[RUNS / 2]),
        ms(&times[RUNS / 2]),
        stage.estimate(start.slots()).bytes()
    );
    for (kernel, timing) in last.iter() {
        println!("    {kernel:<20} {:>4} x {:>9.4} ms in all", timing.count, timing.total_ns as f64 / 1e6);
    }
    Ok(())
}
