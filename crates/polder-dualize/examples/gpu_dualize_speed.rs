//! How fast stage 2 is on a device: medians of ten, by timestamps, after the result was held against the reference.
//! `gpu_dualize_speed [points]...`; `POLDER_DEVICE` names the device.

use polder_dualize::DVec2;
use polder_dualize::gpu::dualize::{Input, Stage};
use polder_dualize::reference::dual;
use polder_flip::gpu::Mesh;
use polder_voronoi::{Diagram, GridMapping, Options, Sites};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const RUNS: usize = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let counts = if arguments.is_empty() { vec!["70000".to_owned()] } else { arguments };
    for count in counts {
        measure(&device, count.parse()?)?;
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

fn measure(device: &Device, count: usize) -> Result<(), Box<dyn std::error::Error>> {
    let points = uniform(count);
    let mapping = GridMapping::fit(&points, &Options::default())?;
    let size = mapping.size();
    let mut engine = Engine::new(device)?;
    let voronoi = polder_voronoi::gpu::Stage::new(device)?;
    let grid = voronoi.buffers(count, size)?;
    let stage = Stage::new(device)?;
    let buffers = stage.buffers(size)?;
    let mesh = Mesh::new(device, count)?;
    {
        let uploaded = Buffer::new(device, "points", count)?;
        engine.upload(uploaded.view(), &points)?;
        let mut recording = Recording::new(device);
        voronoi.record(&mut recording, &mapping, uploaded.view(), &grid)?;
        engine.run(&recording, &RunOptions::default())?;
    }
    let mut recording = Recording::new(device);
    let input = Input { size, colors: grid.colors(), pixels: grid.pixels(), sites: grid.site_count()? };
    let read = stage.record(&mut recording, input, &mesh, &buffers)?;

    let counts = read.result(&engine.run(&recording, &RunOptions::default())?)?;
    println!("{size:?} pixels, {count} points, {} bytes of scratch: {counts:?}", Stage::estimate(size).bytes());
    let order = engine.download_vec(grid.order())?;
    let pixels = engine.download_vec(grid.pixels())?;
    let sites = Sites { size, order, count: counts.sites as usize, pixels };
    let colors = engine.download_vec(grid.colors())?;
    let diagram = Diagram { width: size[0], height: size[1], colors, debris: Vec::new() };
    let expected = dual(&diagram, &sites)?.mesh;
    if mesh.download(&mut engine)? != expected {
        return Err("the device gives another result".into());
    }
    println!("  the reference gives the same");

    // A device that idles runs at low clocks.
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(1) {
        engine.run(&recording, &RunOptions::default())?;
    }
    let mut kernels: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    let mut totals = Vec::new();
    for _ in 0..RUNS {
        let timings = engine.run(&recording, &RunOptions { timestamps: true, ..RunOptions::default() })?.timings;
        totals.push(timings.total().as_nanos() as u64);
        for (kernel, timing) in timings.iter() {
            kernels.entry(kernel.to_string()).or_default().push(timing.total_ns);
        }
    }
    let median = |times: &mut Vec<u64>| {
        times.sort_unstable();
        times[times.len() / 2] as f64 / 1e6
    };
    println!("  all kernels {:.4} ms", median(&mut totals));
    for (kernel, times) in &mut kernels {
        println!("    {kernel:<20} {:>9.4} ms", median(times));
    }
    // Read: colors, sites' pixels; written: triangles and links; bits and slots of corners once each way and back.
    let floor = 4 * diagram.colors.len() * 2 + 4 * sites.count + 32 * counts.triangles as usize;
    println!("  {:.1} MB have to be moved, colors read twice", floor as f64 / 1e6);
    Ok(())
}
