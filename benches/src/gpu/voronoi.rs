//! `cargo xtask bench voronoi`: the digital Voronoi diagram, debris repaired, beside a tuned CUDA program that does not
//! repair it.

use super::{DeviceFacts, Measured, OnDevice, ms};
use glam::DVec2;
use polder::voronoi::gpu::Stage;
use polder::voronoi::{GridMapping, Options, Resolution, reference};
use polder_io::generate;
use polder_vulkan::{Buffer, Recording};
use serde::Serialize;

/// A shape of points, the longer side of the grid, how many points; and the milliseconds that PBA+, tuned, took to color as
/// many seeds on as many pixels, measured before on an NVIDIA H200.
const CASES: [(Shape, u32, usize, Option<f64>); 5] = [
    (Shape::Uniform, 2048, 1_000_000, Some(0.56)),
    (Shape::Uniform, 4096, 3_000_000, Some(1.52)),
    (Shape::Uniform, 8192, 10_000_000, Some(4.00)),
    (Shape::Uniform, 16384, 10_000_000, Some(11.3)),
    // A thin circle leaves much debris.
    (Shape::Circle, 4096, 100_000, None),
];
/// To see that all works.
const QUICK: [(Shape, u32, usize, Option<f64>); 2] =
    [(Shape::Uniform, 256, 9000, None), (Shape::Circle, 128, 600, None)];

#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum Shape {
    Uniform,
    Circle,
}

#[derive(Debug, Serialize)]
pub(crate) struct Results {
    device: DeviceFacts,
    runs: usize,
    /// Whether the results were held against the reference.
    checked: bool,
    cases: Vec<Case>,
}

#[derive(Debug, Serialize)]
struct Case {
    shape: Shape,
    size: [u32; 2],
    points: usize,
    sites: u64,
    debris: u64,
    bytes_held: u64,
    /// Points to sites.
    mapping: Measured,
    /// Coloring, debris found and recolored.
    coloring: Measured,
    /// Bytes that each has to read and write once, and how long that takes by the device's own speed.
    floors: [Floor; 2],
    pba_seconds: Option<f64>,
    /// Seconds of coloring and repair over those of PBA+.
    to_pba: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Floor {
    bytes: u64,
    seconds: f64,
}

pub(crate) fn run(runs: usize, quick: bool, check: bool) -> Result<Results, String> {
    let told = |error: polder_vulkan::Error| error.to_string();
    let mut on = OnDevice::open(runs).map_err(told)?;
    let device = on.facts().map_err(told)?;
    let cases = if quick { &QUICK[..] } else { &CASES };
    let cases = cases
        .iter()
        .map(|&(shape, side, points, pba)| {
            eprintln!("{shape:?}, {points} points, side {side}...");
            case(&mut on, &device, (shape, side, points, pba), check)
        })
        .collect::<Result<_, _>>()?;
    Ok(Results { device, runs, checked: check, cases })
}

fn case(
    on: &mut OnDevice,
    facts: &DeviceFacts,
    (shape, side, count, pba): (Shape, u32, usize, Option<f64>),
    check: bool,
) -> Result<Case, String> {
    let pslg = match shape {
        Shape::Uniform => generate::uniform(count, 1),
        Shape::Circle => generate::circle(count, 1),
    };
    let points: &[DVec2] = pslg.points();
    let options: Options = Resolution::LongerSide(side).into();
    let mapping = GridMapping::fit(points, &options).map_err(|error| error.to_string())?;
    measured(on, facts, shape, points, &mapping, &options, pba, check).map_err(|error| error.to_string())
}

#[expect(clippy::too_many_arguments, reason = "a case with all that belongs to it")]
fn measured(
    on: &mut OnDevice,
    facts: &DeviceFacts,
    shape: Shape,
    points: &[DVec2],
    mapping: &GridMapping,
    options: &Options,
    pba: Option<f64>,
    check: bool,
) -> Result<Case, Box<dyn std::error::Error>> {
    let stage = Stage::new(&on.device)?;
    let buffers = stage.buffers(points.len(), mapping.size())?;
    let input = Buffer::new(&on.device, "points", points.len())?;
    on.engine.upload(input.view(), points)?;
    let mut map = Recording::new(&on.device);
    stage.record_map(&mut map, mapping, input.view(), &buffers)?;
    let mut rest = Recording::new(&on.device);
    stage.record_color(&mut rest, &buffers)?;
    stage.record_repair(&mut rest, &buffers)?;
    let read = buffers.read_counts(&mut rest);

    on.engine.run(&map, &Default::default())?;
    let counts = read.counts(&on.engine.run(&rest, &Default::default())?);
    if check {
        let expected = reference::diagram(points, options)?;
        let same = counts == expected.counts
            && on.engine.download_vec(buffers.order())? == expected.sites.order
            && on.engine.download_vec(buffers.colors())? == expected.diagram.colors;
        if !same {
            return Err("the device gives another result than the reference".into());
        }
    }
    let mapping_time = on.measure(|engine, options| engine.run(&map, options))?;
    let coloring = on.measure(|engine, options| engine.run(&rest, options))?;
    // Points in, numbers and pixels of points out; pixels of sites in, colors out.
    let bytes = [counts.points * (16 + 4 + 4), 4 * counts.sites + 4 * counts.pixels];
    Ok(Case {
        shape,
        size: mapping.size(),
        points: points.len(),
        sites: counts.sites,
        debris: counts.debris,
        bytes_held: stage.estimate(points.len(), mapping.size()).bytes(),
        floors: bytes.map(|bytes| Floor { bytes, seconds: bytes as f64 / facts.bandwidth }),
        pba_seconds: pba.map(|ms| ms / 1e3),
        to_pba: pba.map(|pba| ms(coloring.seconds) / pba),
        mapping: mapping_time,
        coloring,
    })
}

impl Results {
    pub(crate) fn print(&self) {
        let DeviceFacts { name, driver, bandwidth, .. } = &self.device;
        println!("\n{name} ({driver}), {:.2} TB/s read and written by a copy", bandwidth / 1e12);
        println!(
            "Milliseconds by timestamps, median of {}; floor: input and output moved once at that speed",
            self.runs
        );
        println!("PBA+: tuned CUDA, which repairs no debris, measured before on an NVIDIA H200");
        if !self.checked {
            println!("(not held against the reference)");
        }
        println!(
            "{:<9} {:>13} {:>11} {:>9}  {:>8} {:>6} {:>8}  {:>8} {:>6} {:>8} {:>5}  {:>6} {:>5}",
            "points",
            "",
            "pixels",
            "debris",
            "mapping",
            "floor",
            "of it",
            "coloring",
            "floor",
            "of it",
            "waits",
            "PBA+",
            "ratio"
        );
        for case in &self.cases {
            let [map_floor, floor] = case.floors;
            let over = |measured: &Measured, floor: Floor| format!("{:.1} x", measured.seconds / floor.seconds);
            let pba = case.pba_seconds.map_or("-".into(), |seconds| format!("{:.2}", ms(seconds)));
            let ratio = case.to_pba.map_or("-".into(), |ratio| format!("{ratio:.2}"));
            println!(
                "{:<9} {:>13} {:>11} {:>9}  {:>8.3} {:>6.3} {:>8}  {:>8.3} {:>6.3} {:>8} {:>5}  {:>6} {:>5}",
                format!("{:?}", case.shape).to_lowercase(),
                case.points,
                format!("{}x{}", case.size[0], case.size[1]),
                case.debris,
                ms(case.mapping.seconds),
                ms(map_floor.seconds),
                over(&case.mapping, map_floor),
                ms(case.coloring.seconds),
                ms(floor.seconds),
                over(&case.coloring, floor),
                case.coloring.waits,
                pba,
                ratio,
            );
        }
        for case in &self.cases {
            println!("\n{:?}, {} points on {:?} pixels", case.shape, case.points, case.size);
            for (name, measured) in [("mapping", &case.mapping), ("coloring and repair", &case.coloring)] {
                let clock = ms(measured.clock_seconds);
                println!("  {name}: {:.3} ms by kernels, {clock:.3} ms by the clock", ms(measured.seconds));
                for kernel in &measured.kernels {
                    println!("    {:<20} {:>5} x {:>9.4} ms in all", kernel.name, kernel.count, ms(kernel.seconds));
                }
            }
        }
    }
}
