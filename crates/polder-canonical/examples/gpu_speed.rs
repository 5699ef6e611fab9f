//! How fast the step is on a device: medians of ten by timestamps, after the result was held against `polder-mesh`.
//! `gpu_speed [family:points]...`, where the family is `uniform`, `lattice` or `hub`; `POLDER_DEVICE` names the device.

use polder_canonical::gpu::{Input, Stage};
use polder_cpu::Delaunay;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_io::generate;
use polder_mesh::{Chains, DVec2, Monitor};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions};
use std::time::{Duration, Instant};

const RUNS: usize = 10;
const WARM: Duration = Duration::from_secs(1);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec!["uniform:20000".to_owned()] } else { arguments };
    for case in cases {
        let (family, points) = case.split_once(':').ok_or("a case is family:points")?;
        let count = points.parse()?;
        let points = match family {
            "uniform" => generate::uniform(count, 1).into_parts().0,
            "lattice" => generate::lattice(count.isqrt(), count.isqrt()).into_parts().0,
            "hub" => {
                let rim = generate::circle(count, 1).into_parts().0;
                std::iter::once(DVec2::ZERO).chain(rim).collect()
            }
            other => return Err(format!("no family is called {other}").into()),
        };
        measure(&device, family, &points)?;
    }
    Ok(())
}

fn measure(device: &Device, family: &str, points: &[DVec2]) -> Result<(), Box<dyn std::error::Error>> {
    let delaunay = Delaunay::new(points, Monitor::default())?;
    let (mesh, positions, order) = delaunay.to_ghost_mesh();
    let vertex_of: Vec<u32> = (0..order.len() as u32).collect();
    let expected = delaunay.finish(Chains::default());

    let mut engine = Engine::new(device)?;
    let stage = Stage::new(device, Arithmetic::of(device)?)?;
    let on_device = Mesh::new(device, positions.len())?;
    on_device.upload(&mut engine, &mesh, &positions)?;
    let uploaded = |engine: &mut Engine, data: &[u32]| {
        let buffer = Buffer::new(device, "input", data.len())?;
        engine.upload(buffer.view(), data).map(|()| buffer)
    };
    let (vertex_of, order) = (uploaded(&mut engine, &vertex_of)?, uploaded(&mut engine, &order)?);
    let buffers = stage.buffers(positions.len(), on_device.capacity())?;
    let input = Input { mesh: &on_device, vertex_of: vertex_of.view(), order: order.view(), chains: None };
    let mut recording = Recording::new(device);
    let read = stage.record(&mut recording, &input, &buffers)?;

    let counts = read.counts(&engine.run(&recording, &RunOptions::default())?);
    counts.verdict()?;
    let found = counts.triangles as usize;
    let same = engine.download_vec(buffers.triangles().slice(0..found)?)? == expected.triangles()
        && engine.download_vec(buffers.neighbors().slice(0..found)?)? == expected.neighbors();
    println!("{family}, {} points: {counts:?}; equal: {same}", points.len());
    if !same {
        return Err("the device gives another result".into());
    }
    // A card that was idle is slow at first.
    let start = Instant::now();
    while start.elapsed() < WARM {
        engine.run(&recording, &RunOptions::default())?;
    }
    let mut runs = Vec::new();
    for _ in 0..RUNS {
        let timed = RunOptions { timestamps: true, ..RunOptions::default() };
        runs.push(engine.run(&recording, &timed)?.timings);
    }
    runs.sort_by_key(|timings| timings.total());
    println!("{}", runs[RUNS / 2]);
    Ok(())
}
