//! How fast stage 3 is on a device: medians of ten, by timestamps and by the clock, after the result was held against the reference.
//! `shift_speed [[circle:|ring:]points]...`; a trailing `?` leaves the reference out, as in `10000000?`. `POLDER_DEVICE`
//! names the device.

use polder_dualize::gpu::{dualize, shift};
use polder_dualize::{DVec2, reference};
use polder_flip::FlipReport;
use polder_flip::gpu::{Arithmetic, Mesh, Tally};
use polder_voronoi::{GridMapping, Options};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions};
use std::collections::BTreeMap;
use std::time::Instant;

const RUNS: usize = 10;

type Failed = Box<dyn std::error::Error>;

fn main() -> Result<(), Failed> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec!["20000".to_owned()] } else { arguments };
    for case in cases {
        let (shape, count) = case.trim_end_matches('?').split_once(':').unwrap_or(("square", &case));
        let points = scattered(shape, count.trim_end_matches('?').parse()?);
        println!("{shape}:");
        measure(&device, &points, !case.ends_with('?'))?;
    }
    Ok(())
}

/// Points anywhere in a square, on a circle, or in a ring a hundredth of its radius wide.
fn scattered(shape: &str, count: usize) -> Vec<DVec2> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state ^ (state >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / 2f64.powi(53)
    };
    let mut point = || {
        let (x, y) = (next(), next());
        let angle = DVec2::from_angle(std::f64::consts::TAU * x);
        match shape {
            "circle" => angle,
            "ring" => angle * (1.0 + 0.01 * y),
            _ => DVec2::new(x, y),
        }
    };
    (0..count).map(|_| point()).collect()
}

fn measure(device: &Device, points: &[DVec2], check: bool) -> Result<(), Failed> {
    let count = points.len();
    let mapping = GridMapping::fit(points, &Options::default())?;
    let mut engine = Engine::new(device)?;
    let uploaded = Buffer::new(device, "points", count)?;
    engine.upload(uploaded.view(), points)?;
    let voronoi = polder_voronoi::gpu::Stage::new(device)?;
    let diagram = voronoi.buffers(count, mapping.size())?;
    let dual = dualize::Stage::new(device)?;
    let dual_buffers = dual.buffers(mapping.size())?;
    let mesh = Mesh::new(device, count)?;
    let sites = diagram.site_count()?;

    let mut recording = Recording::new(device);
    voronoi.record(&mut recording, &mapping, uploaded.view(), &diagram)?;
    let (size, colors, pixels) = (mapping.size(), diagram.colors(), diagram.pixels());
    let input = dualize::Input { size, colors, pixels, sites };
    let read = dual.record(&mut recording, input, &mesh, &dual_buffers)?;
    read.result(&engine.run(&recording, &RunOptions::default())?)?;
    let order = engine.download_vec(diagram.order())?;
    let all_pixels = engine.download_vec(pixels)?;
    let site_count = engine.download_vec(sites)?[0] as usize;

    let flip = polder_flip::gpu::Stage::new(device)?;
    let (flip_buffers, tally) = (flip.buffers(mesh.capacity())?, Tally::new(device)?);
    let mut before = Recording::new(device);
    dual.record(&mut before, input, &mesh, &dual_buffers)?;
    flip.record_start(&mut before, &flip_buffers);

    let stage = shift::Stage::new(device, Arithmetic::of(device)?)?;
    let buffers = stage.buffers(count)?;
    let points_view = uploaded.view();
    let input = shift::Input { mapping: &mapping, points: points_view, order: diagram.order(), pixels, sites };
    let mut recording = Recording::new(device);
    tally.record_clear(&mut recording);
    let flips = shift::Flips { stage: &flip, buffers: &flip_buffers, tally: &tally };
    let read = stage.record(&mut recording, input, &mesh, flips, &buffers)?;
    let hull = tally.read(&mut recording);

    // A device that was idle is slow at first.
    let warm = Instant::now();
    while warm.elapsed().as_secs_f64() < 0.7 {
        engine.run(&before, &RunOptions::default())?;
        engine.run(&recording, &RunOptions::default())?;
    }
    let options = RunOptions { timestamps: true, ..RunOptions::default() };
    let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let (mut totals, mut clock, mut waits) = (Vec::new(), Vec::new(), 0);
    let (mut counts, mut flips) = (shift::Counts::default(), FlipReport::default());
    for _ in 0..RUNS {
        engine.run(&before, &RunOptions::default())?;
        let start = Instant::now();
        waits = engine.run(&recording, &RunOptions::default())?.waits;
        clock.push(start.elapsed().as_secs_f64() * 1e3);
        engine.run(&before, &RunOptions::default())?;
        let report = engine.run(&recording, &options)?;
        (counts, flips) = (read.result(&report)?, hull.report(&report));
        totals.push(report.timings.total().as_secs_f64() * 1e3);
        for (kernel, timing) in report.timings.iter() {
            let name = format!("{kernel:<20} {:>4} x", timing.count);
            times.entry(name).or_default().push(timing.total_ns as f64 / 1e6);
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    println!(
        "{count} points, {site_count} sites, {} bytes: {counts:?}, {flips:?}",
        shift::Stage::estimate(count).bytes()
    );
    println!("  {:.3} ms by kernels, {:.3} ms with {waits} waits", median(totals), median(clock));
    for (name, times) in times {
        println!("    {name} {:>9.4} ms in all", median(times));
    }
    if check {
        let positions: Vec<DVec2> = order.iter().map(|&i| points[i as usize]).collect();
        let centers: Vec<DVec2> = all_pixels[..site_count].iter().map(|p| mapping.center(p.map(u32::from))).collect();
        let found = mesh.download(&mut engine)?;
        engine.run(&before, &RunOptions::default())?;
        let expected = reference::shift(mesh.download(&mut engine)?, &centers, &positions)?;
        let same = (counts.bad, counts.stuck, counts.rounds)
            == (expected.bad as u64, expected.stuck as u64, expected.rounds)
            && engine.download_vec(buffers.heirs())?[..site_count] == expected.heirs
            && found == expected.mesh;
        println!("  the reference gives the same: {same}");
        if !same {
            return Err("the device gives another result".into());
        }
    }
    Ok(())
}
