//! How fast the stage is on a device, repair included: medians of ten, by timestamps and by the clock, after the result was
//! held against the reference. `gpu_speed [case]...`, a case being `[shape:]side:points[,name=value]...`: shapes are `uniform`
//! (unless told), `circle`, `ring`, `clusters`, `same`; names are `radius`, `rows` and `columns` of [`Tuning`], and `check=0` to do
//! without the reference. Say `2048:1000000 circle:8192:10000000,radius=12`. `POLDER_DEVICE` names the device.

use polder_voronoi::gpu::{Stage, Tuning};
use polder_voronoi::{DVec2, GridMapping, Options, Resolution, reference};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions, Timings};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error>;

const RUNS: usize = 10;
const WARM_UP: Duration = Duration::from_millis(700);

struct Case {
    name: String,
    shape: String,
    side: u32,
    points: usize,
    tuning: Tuning,
    check: bool,
}

impl Case {
    fn parse(name: &str) -> Result<Self, Failure> {
        let mut parts = name.split(',');
        let size: Vec<&str> = parts.next().unwrap_or_default().split(':').collect();
        let (shape, side, points) = match size[..] {
            [side, points] => ("uniform", side, points),
            [shape, side, points] => (shape, side, points),
            _ => return Err("a case is shape:side:points".into()),
        };
        let mut case = Case {
            name: name.to_owned(),
            shape: shape.to_owned(),
            side: side.parse()?,
            points: points.parse()?,
            tuning: Tuning::default(),
            check: true,
        };
        for part in parts {
            let (name, value) = part.split_once('=').ok_or("name=value")?;
            let value: u32 = value.parse()?;
            match name {
                "radius" => case.tuning.radius = value,
                "rows" => case.tuning.rows = value,
                "columns" => case.tuning.columns = value,
                "tile_lanes" => case.tuning.tile_lanes = value,
                "row_lanes" => case.tuning.row_lanes = value,
                "check" => case.check = value != 0,
                _ => return Err(format!("no {name}").into()),
            }
        }
        Ok(case)
    }

    fn points(&self) -> Result<Vec<DVec2>, Failure> {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state ^ (state >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1_u64 << 53) as f64
        };
        let around = |turn: f64, radius: f64| {
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            DVec2::new(cos * radius, sin * radius)
        };
        let shape = self.shape.as_str();
        let mut point = |i: usize| match shape {
            "uniform" => Some(DVec2::new(next(), next())),
            "circle" => Some(around(next(), 1.0)),
            "ring" => Some(around(next(), 0.9 + 0.1 * next())),
            "clusters" => {
                let center = DVec2::new((i % 10) as f64, (i / 10 % 10) as f64);
                Some(center + around(next(), 1e-3 * next()))
            }
            "same" => Some(DVec2::new((i % 2) as f64, (i / 2 % 2) as f64)),
            _ => None,
        };
        (0..self.points).map(|i| point(i).ok_or_else(|| format!("no shape {shape}").into())).collect()
    }
}

fn main() -> Result<(), Failure> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec!["512:40000".to_owned()] } else { arguments };
    for case in cases {
        measure(&device, &Case::parse(&case)?)?;
    }
    Ok(())
}

fn measure(device: &Device, case: &Case) -> Result<(), Failure> {
    let points = case.points()?;
    let options: Options = Resolution::LongerSide(case.side).into();
    let mapping = GridMapping::fit(&points, &options)?;
    let mut engine = Engine::new(device)?;
    let stage = Stage::with_tuning(device, case.tuning)?;
    let buffers = stage.buffers(points.len(), mapping.size())?;
    let uploaded = Buffer::new(device, "points", points.len())?;
    engine.upload(uploaded.view(), &points)?;

    let mut map = Recording::new(device);
    stage.record_map(&mut map, &mapping, uploaded.view(), &buffers)?;
    let mut rest = Recording::new(device);
    stage.record_color(&mut rest, &buffers)?;
    stage.record_repair(&mut rest, &buffers)?;
    let read = buffers.read_counts(&mut rest);

    engine.run(&map, &RunOptions::default())?;
    let report = engine.run(&rest, &RunOptions::default())?;
    let counts = read.counts(&report);
    let bytes = stage.estimate(points.len(), mapping.size()).bytes();
    println!("{}: {counts}; {} tiles left to bands; {bytes} bytes", case.name, read.tiles_left(&report));
    if case.check {
        let start = Instant::now();
        let expected = reference::diagram(&points, &options)?;
        let same = [
            counts == expected.counts,
            engine.download_vec(buffers.order())? == expected.sites.order,
            engine.download_vec(buffers.pixels())? == expected.sites.pixels,
            engine.download_vec(buffers.colors())? == expected.diagram.colors,
        ];
        println!("  the reference, {:.2} s on a core, gives the same: {same:?}", start.elapsed().as_secs_f64());
        if same.contains(&false) {
            return Err("the device gives another result".into());
        }
    }
    // What must be read and written once: points and their pixels and numbers; a bit and a color for each pixel.
    let bits = counts.pixels / 8;
    let floors = [counts.points * (16 + 4 + 4) + bits, bits + 4 * counts.pixels];
    for ((name, recording), floor) in [("mapping", &map), ("coloring and repair", &rest)].into_iter().zip(floors) {
        let mut clock = Vec::new();
        let mut kernels = Vec::new();
        let mut timings: Vec<Timings> = Vec::new();
        // A card that has waited for the host runs slowly at first.
        let start = Instant::now();
        while start.elapsed() < WARM_UP {
            engine.run(recording, &RunOptions::default())?;
        }
        for _ in 0..RUNS {
            let start = Instant::now();
            engine.run(recording, &RunOptions::default())?;
            clock.push(start.elapsed());
            let last = engine.run(recording, &RunOptions { timestamps: true, ..RunOptions::default() })?.timings;
            kernels.push(last.total());
            timings.push(last);
        }
        clock.sort();
        kernels.sort();
        let ms = |times: &[Duration]| times[RUNS / 2].as_secs_f64() * 1e3;
        let (by_kernels, floor_ms) = (ms(&kernels), floor as f64 / 3.9e9);
        println!("  {name}: {by_kernels:.3} ms by kernels, {:.3} ms with all waits", ms(&clock));
        println!("    {floor} bytes at least: {floor_ms:.3} ms at 3.9 TB/s, {:.1} times that", by_kernels / floor_ms);
        let mut by_name: BTreeMap<&str, (u64, Vec<u64>)> = BTreeMap::new();
        for (kernel, timing) in timings.iter().flat_map(|timings| timings.iter()) {
            let entry = by_name.entry(kernel).or_default();
            entry.0 = timing.count;
            entry.1.push(timing.total_ns);
        }
        let mut rows: Vec<(u64, u64, &str)> = Vec::new();
        for (kernel, (count, mut times)) in by_name {
            times.sort_unstable();
            rows.push((times[times.len() / 2], count, kernel));
        }
        rows.sort_unstable_by(|a, b| b.cmp(a));
        for (ns, count, kernel) in rows {
            println!("    {kernel:<20} {count:>4} x {:>9.4} ms in all", ns as f64 / 1e6);
        }
    }
    Ok(())
}
