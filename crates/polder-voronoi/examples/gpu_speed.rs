//! How fast the stage is on a device, repair included: medians of ten, by timestamps and by the clock, after the result was
//! held against the reference. `gpu_speed [side:points]...`, say `2048:1000000`; `POLDER_DEVICE` names the device.

use polder_voronoi::gpu::Stage;
use polder_voronoi::{DVec2, GridMapping, Options, Resolution, reference};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions, Timings};
use std::time::Instant;

const RUNS: usize = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec!["512:70000".to_owned()] } else { arguments };
    for case in cases {
        let (side, points) = case.split_once(':').ok_or("a case is side:points")?;
        measure(&device, side.parse()?, points.parse()?)?;
    }
    Ok(())
}

/// Points anywhere in a square.
fn uniform(count: usize) -> Vec<DVec2> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state ^ (state >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64
    };
    (0..count).map(|_| DVec2::new(next(), next())).collect()
}

fn measure(device: &Device, side: u32, count: usize) -> Result<(), Box<dyn std::error::Error>> {
    let points = uniform(count);
    let options: Options = Resolution::LongerSide(side).into();
    let mapping = GridMapping::fit(&points, &options)?;
    let mut engine = Engine::new(device)?;
    let stage = Stage::new(device)?;
    let buffers = stage.buffers(count, mapping.size())?;
    let uploaded = Buffer::new(device, "points", count)?;
    engine.upload(uploaded.view(), &points)?;

    let mut map = Recording::new(device);
    stage.record_map(&mut map, &mapping, uploaded.view(), &buffers)?;
    let mut rest = Recording::new(device);
    stage.record_color(&mut rest, &buffers)?;
    stage.record_repair(&mut rest, &buffers)?;
    let read = buffers.read_counts(&mut rest);

    engine.run(&map, &RunOptions::default())?;
    let counts = read.counts(&engine.run(&rest, &RunOptions::default())?);
    println!(
        "{side} x {side} pixels, {count} points, {} bytes: {counts}",
        stage.estimate(count, mapping.size()).bytes()
    );
    let start = Instant::now();
    let expected = reference::diagram(&points, &options)?;
    let same = engine.download_vec(buffers.order())? == expected.sites.order
        && engine.download_vec(buffers.pixels())? == expected.sites.pixels
        && engine.download_vec(buffers.colors())? == expected.diagram.colors
        && counts == expected.counts;
    println!("  the reference, {:.2} s on a core, gives the same: {same}", start.elapsed().as_secs_f64());
    if !same {
        return Err("the device gives another result".into());
    }
    for (name, recording) in [("mapping", &map), ("coloring and repair", &rest)] {
        let (mut clock, mut kernels, mut last) = (Vec::new(), Vec::new(), Timings::default());
        for _ in 0..RUNS {
            let start = Instant::now();
            engine.run(recording, &RunOptions::default())?;
            clock.push(start.elapsed());
            last = engine.run(recording, &RunOptions { timestamps: true, ..RunOptions::default() })?.timings;
            kernels.push(last.total());
        }
        clock.sort();
        kernels.sort();
        let ms = |times: &[std::time::Duration]| times[RUNS / 2].as_secs_f64() * 1e3;
        println!("  {name}: {:.3} ms by kernels, {:.3} ms with all waits", ms(&kernels), ms(&clock));
        for (kernel, timing) in last.iter() {
            println!("    {kernel:<20} {:>4} x {:>9.4} ms in all", timing.count, timing.total_ns as f64 / 1e6);
        }
    }
    Ok(())
}
