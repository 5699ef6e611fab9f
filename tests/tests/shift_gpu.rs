//! Stage 3 on the device against its reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use glam::DVec2;
use polder_dualize::gpu::shift::{Flips, Input, Stage};
use polder_dualize::{Dualized, Shifted, reference};
use polder_flip::gpu::{Arithmetic, Mesh, Tally};
use polder_tests::{families, point_families};
use polder_voronoi::reference::Output;
use polder_voronoi::{Options, Resolution};
use vulkan_support::Gpu;

struct Case {
    points: Vec<DVec2>,
    voronoi: Output,
    dualized: Dualized,
    shifted: Shifted,
}

struct Stages {
    shift: Stage,
    flip: polder_flip::gpu::Stage,
}

impl Stages {
    fn new(gpu: &Gpu, arithmetic: Arithmetic) -> Self {
        let flip = polder_flip::gpu::Stage::with_arithmetic(&gpu.device, arithmetic).unwrap();
        Self { shift: Stage::new(&gpu.device, arithmetic).unwrap(), flip }
    }
}

fn case(points: &[DVec2], options: &Options) -> Case {
    let phases = reference::triangulate(points, options).unwrap();
    Case { points: points.to_vec(), voronoi: phases.voronoi, dualized: phases.dualized, shifted: phases.shifted }
}

/// The same with a dual whose hull is convex: that asks for more, and pins more sites.
fn closed_before(case: Case) -> Case {
    let Output { diagram, sites, mapping, .. } = &case.voronoi;
    let dualized = reference::dualize(diagram, sites).unwrap();
    let centers: Vec<DVec2> = sites.pixels[..sites.count].iter().map(|p| mapping.center(p.map(u32::from))).collect();
    let truth: Vec<DVec2> = sites.order.iter().map(|&i| case.points[i as usize]).collect();
    let shifted = reference::shift(dualized.mesh.clone(), &centers, &truth).unwrap();
    Case { dualized, shifted, ..case }
}

fn check(gpu: &mut Gpu, stages: &Stages, name: &str, case: &Case) {
    let Case { points, voronoi, dualized, shifted } = case;
    let (sites, count) = (&voronoi.sites, points.len());
    let mesh = Mesh::new(&gpu.device, count).unwrap();
    let positions: Vec<DVec2> = sites.order.iter().map(|&i| points[i as usize]).collect();
    mesh.upload(&mut gpu.engine, &dualized.mesh, &vec![DVec2::ZERO; count]).unwrap();
    let (points, order) = (gpu.buffer(points), gpu.buffer(&sites.order));
    let (pixels, site_count) = (gpu.buffer(&sites.pixels), gpu.buffer(&[sites.count as u32]));
    let buffers = stages.shift.buffers(count).unwrap();
    let flip_buffers = stages.flip.buffers(mesh.capacity()).unwrap();
    let tally = Tally::new(&gpu.device).unwrap();
    let input = Input {
        mapping: &voronoi.mapping,
        points: points.view(),
        order: order.view(),
        pixels: pixels.view(),
        sites: site_count.view(),
    };
    let flips = Flips { stage: &stages.flip, buffers: &flip_buffers, tally: &tally };
    let mut recording = gpu.recording();
    tally.record_clear(&mut recording);
    stages.flip.record_start(&mut recording, &flip_buffers);
    let read = stages.shift.record(&mut recording, input, &mesh, flips, &buffers).unwrap();
    let hull = tally.read(&mut recording);
    let report = gpu.run(&recording);
    let counts = read.result(&report).unwrap();
    let found = (counts.bad, counts.stuck, counts.rounds);
    assert_eq!(found, (shifted.bad as u64, shifted.stuck as u64, shifted.rounds), "{name}: counts");
    let hull = hull.report(&report);
    assert_eq!((hull.rounds, hull.flips), (shifted.hull.rounds, shifted.hull.flips), "{name}: hull");
    let heirs = gpu.fetch(buffers.heirs());
    assert!(heirs[..sites.count] == shifted.heirs, "{name}: heirs");
    let ended = mesh.download(&mut gpu.engine).unwrap();
    assert!(ended == shifted.mesh, "{name}: mesh");
    let bits = |points: &[DVec2]| points.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
    assert!(bits(&gpu.fetch(mesh.positions())) == bits(&positions), "{name}: positions");
    let mut taken = gpu.fetch(buffers.taken())[..counts.taken as usize].to_vec();
    taken.sort_unstable();
    let freed = gpu.fetch(buffers.freed());
    assert_eq!(taken, shifted.taken_out().map(|(site, _)| site).collect::<Vec<_>>(), "{name}: taken out");
    if shifted.mesh.slots() > 0 {
        assert!(taken.iter().all(|&v| freed[v as usize] == shifted.freed[v as usize]), "{name}: freed");
    }
}

fn check_points(gpu: &mut Gpu, stages: &Stages, name: &str, points: &[DVec2], options: &Options) {
    check(gpu, stages, name, &case(points, options));
}

#[test]
fn every_family() {
    let mut gpu = Gpu::open();
    for arithmetic in [Arithmetic::Filtered, Arithmetic::Integers] {
        let stages = Stages::new(&gpu, arithmetic);
        for (name, pslg) in families(1000, 31) {
            for options in [Options::default(), Resolution::LongerSide(40).into()] {
                check_points(&mut gpu, &stages, name, pslg.points(), &options);
            }
            let closed = closed_before(case(pslg.points(), &Options::default()));
            check(&mut gpu, &stages, name, &closed);
        }
    }
}

#[test]
fn every_number_of_points_around_a_workgroup() {
    let mut gpu = Gpu::open();
    let stages = Stages::new(&gpu, Arithmetic::Filtered);
    for count in [1, 2, 3, 4, 5, 127, 128, 129, 4095, 4097] {
        let points = polder_io::generate::uniform(count, count as u64);
        check_points(&mut gpu, &stages, "uniform", points.points(), &Options::default());
    }
}

/// Few points on flat arcs, with a convex hull: often a chain is left, or nothing.
#[test]
fn small_arcs() {
    let mut gpu = Gpu::open();
    let stages = Stages::new(&gpu, Arithmetic::Filtered);
    let (mut chains, mut empty) = (0, 0);
    for seed in 0..2000 {
        let words = vulkan_support::words(seed, 16);
        let unit = |i: usize| f64::from(words[i]) / 2f64.powi(32);
        let (bend, tilt) = (0.2 * unit(0), unit(1) - 0.5);
        let arc = |i| DVec2::new(unit(i), bend * unit(i) * (unit(i) - 1.0) + tilt * unit(i));
        let points: Vec<DVec2> = (4..7 + seed as usize % 8).map(arc).collect();
        let case = closed_before(case(&points, &Resolution::LongerSide(4 + words[2] % 12).into()));
        if case.dualized.mesh.finite().next().is_some() && case.shifted.mesh.finite().next().is_none() {
            let is_empty = case.shifted.mesh.slots() == 0;
            *(if is_empty { &mut empty } else { &mut chains }) += 1;
            if is_empty || chains < 30 {
                check(&mut gpu, &stages, "arc", &case);
            }
        }
    }
    assert!(chains > 10 && empty > 1, "{chains} chains, {empty} empty");
}

/// With some points many pixels long, so that stars are large and rounds are many.
#[test]
#[ignore = "long: cargo xtask ci --long"]
fn every_large_family() {
    let mut gpu = Gpu::open();
    let stages = Stages::new(&gpu, Arithmetic::Filtered);
    for (name, pslg) in point_families(20_000, 33) {
        check_points(&mut gpu, &stages, name, pslg.points(), &Options::default());
    }
}

#[test]
fn a_recording_serves_again() {
    let mut gpu = Gpu::open();
    let stages = Stages::new(&gpu, Arithmetic::Filtered);
    let uniform = polder_io::generate::uniform(2000, 5);
    let Case { points, voronoi, dualized, shifted } = case(uniform.points(), &Options::default());
    let mesh = Mesh::new(&gpu.device, points.len()).unwrap();
    let buffers = stages.shift.buffers(voronoi.sites.count).unwrap();
    let flip_buffers = stages.flip.buffers(mesh.capacity()).unwrap();
    let tally = Tally::new(&gpu.device).unwrap();
    let (points, order) = (gpu.buffer(&points), gpu.buffer(&voronoi.sites.order));
    let (pixels, sites) = (gpu.buffer(&voronoi.sites.pixels), gpu.buffer(&[voronoi.sites.count as u32]));
    let (mapping, points, order) = (&voronoi.mapping, points.view(), order.view());
    let input = Input { mapping, points, order, pixels: pixels.view(), sites: sites.view() };
    let mut recording = gpu.recording();
    stages.flip.record_start(&mut recording, &flip_buffers);
    let flips = Flips { stage: &stages.flip, buffers: &flip_buffers, tally: &tally };
    stages.shift.record(&mut recording, input, &mesh, flips, &buffers).unwrap();
    for _ in 0..3 {
        mesh.upload(&mut gpu.engine, &dualized.mesh, &vec![DVec2::ONE; points.len()]).unwrap();
        gpu.run(&recording);
        assert!(mesh.download(&mut gpu.engine).unwrap() == shifted.mesh);
        assert!(gpu.fetch(buffers.heirs()) == shifted.heirs);
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut gpu = Gpu::open();
    let stages = Stages::new(&gpu, Arithmetic::Filtered);
    let points = gpu.buffer(&[DVec2::ZERO, DVec2::ONE, DVec2::X]);
    let (order, pixels) = (gpu.buffer(&[0_u32, 1, 2]), gpu.buffer(&[[0_u16; 2]; 3]));
    let sites = gpu.buffer(&[3_u32]);
    let mapping = polder_voronoi::GridMapping::fit(&[DVec2::ZERO, DVec2::ONE], &Options::default()).unwrap();
    let tally = Tally::new(&gpu.device).unwrap();
    let (points, order, pixels) = (points.view(), order.view(), pixels.view());
    let input = Input { mapping: &mapping, points, order, pixels, sites: sites.view() };
    let short = |input: Input<'_>, sites: usize, vertices: usize| {
        let mesh = Mesh::new(&gpu.device, vertices).unwrap();
        let (buffers, flip_buffers) =
            (stages.shift.buffers(sites).unwrap(), stages.flip.buffers(mesh.capacity()).unwrap());
        let flips = Flips { stage: &stages.flip, buffers: &flip_buffers, tally: &tally };
        let mut recording = gpu.recording();
        stages.shift.record(&mut recording, input, &mesh, flips, &buffers).is_err() && recording.is_empty()
    };
    assert!(!short(input, 3, 3));
    assert!(short(input, 4, 4));
    assert!(short(input, 3, 2));
    assert!(short(Input { order: order.slice(0..2).unwrap(), ..input }, 3, 3));
    assert!(short(Input { pixels: pixels.slice(0..2).unwrap(), ..input }, 3, 3));
}
