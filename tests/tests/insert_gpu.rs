//! Stage 4 on the device against its reference, slot by slot.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use glam::DVec2;
use polder_dualize::gpu::insert::{Counts, Input, Stage};
use polder_dualize::reference::{self, ToInsert};
use polder_dualize::{DualizeError, Inserted, Shifted};
use polder_flip::gpu::{self as flips, Arithmetic, Mesh};
use polder_tests::point_families;
use polder_voronoi::{Options, Resolution};
use vulkan_support::Gpu;

struct Stages {
    insert: Stage,
    flips: flips::Stage,
}

/// A device, and the stage by both arithmetics.
fn stages() -> (Gpu, [Stages; 2]) {
    let gpu = Gpu::open();
    let stages = [Arithmetic::Filtered, Arithmetic::Integers].map(|arithmetic| Stages {
        insert: Stage::with_arithmetic(&gpu.device, arithmetic).unwrap(),
        flips: flips::Stage::with_arithmetic(&gpu.device, arithmetic).unwrap(),
    });
    (gpu, stages)
}

/// What stages 1 to 3 of the reference leave.
struct Case {
    positions: Vec<DVec2>,
    shifted: Shifted,
    sites: u32,
    new: ToInsert,
}

impl Case {
    fn new(points: &[DVec2], options: &Options) -> (Self, Inserted) {
        let phases = reference::triangulate(points, options).unwrap();
        let positions = phases.positions(points);
        let new = reference::points_to_insert(&phases.voronoi.diagram, &phases.voronoi.sites, &phases.shifted);
        let sites = phases.voronoi.sites.count as u32;
        (Self { positions, shifted: phases.shifted, sites, new }, phases.inserted)
    }
}

/// Runs the stage and compares all that it leaves.
fn assert_inserted(gpu: &mut Gpu, stages: &Stages, name: &str, case: &Case, expected: &Inserted) {
    let vertices = case.positions.len();
    let mesh = Mesh::new(&gpu.device, vertices).unwrap();
    mesh.upload(&mut gpu.engine, &case.shifted.mesh, &case.positions).unwrap();
    let flip_buffers = stages.flips.buffers(mesh.capacity()).unwrap();
    let buffers = stages.insert.buffers(vertices, mesh.capacity()).unwrap();
    let (points, starts) = (gpu.buffer(&case.new.points), gpu.buffer(&case.new.starts));
    let (sites, freed) = (gpu.buffer(&[case.sites]), gpu.buffer(&case.shifted.freed));
    let input =
        Input { points: points.view(), starts: starts.view(), count: None, sites: sites.view(), freed: freed.view() };
    let mut recording = gpu.recording();
    stages.flips.record_start(&mut recording, &flip_buffers);
    let read = stages.insert.record(&mut recording, &mesh, (&stages.flips, &flip_buffers), &buffers, input).unwrap();
    let counts = read.result(&gpu.run(&recording)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let on_a_line = expected.mesh.finite().next().is_none();
    assert_eq!(counts.on_a_line, on_a_line, "{name}");
    if on_a_line {
        return;
    }
    let wanted = Counts {
        on_a_line,
        rounds: expected.rounds,
        inserted: expected.inserted,
        duplicates: expected.duplicates,
        hull: expected.hull,
        flips: expected.flips,
    };
    assert_eq!(counts, wanted, "{name}");
    assert!(gpu.fetch(buffers.vertex_of()) == expected.vertex_of, "{name}: vertices of points");
    assert!(mesh.download(&mut gpu.engine).unwrap() == expected.mesh, "{name}: mesh");
}

#[test]
fn every_family() {
    let (mut gpu, stages) = stages();
    for (n, seed) in [(3, 29), (7, 30), (60, 31), (1500, 32)] {
        for (name, pslg) in point_families(n, seed) {
            let (case, expected) = Case::new(pslg.points(), &Options::default());
            for stages in &stages {
                assert_inserted(&mut gpu, stages, name, &case, &expected);
            }
        }
    }
}

#[test]
fn few_sites_and_many_points() {
    let (mut gpu, stages) = stages();
    for (turn, (name, pslg)) in point_families(700, 33).into_iter().enumerate() {
        let (case, expected) = Case::new(pslg.points(), &Resolution::LongerSide(4).into());
        assert_inserted(&mut gpu, &stages[turn % 2], name, &case, &expected);
    }
}

#[test]
fn meshes_that_fall_behind() {
    let (mut gpu, stages) = stages();
    for (turn, (name, pslg)) in [
        ("concentric circles", polder_io::generate::concentric(1_500, 4, 1)),
        ("points beside a line", polder_io::generate::near_collinear(1_500, 1, 1)),
        ("mixed magnitudes", polder_io::generate::mixed_magnitudes(1_500, 1)),
        ("concentric circles", polder_io::generate::concentric(4_000, 4, 2)),
        ("cocircular", polder_io::generate::cocircular(3_000, 1)),
    ]
    .into_iter()
    .enumerate()
    {
        let (case, expected) = Case::new(pslg.points(), &Options::default());
        assert!(expected.flips.rounds > 2 * expected.rounds, "{name}: {} in {}", expected.flips, expected.rounds);
        assert_inserted(&mut gpu, &stages[turn % 2], name, &case, &expected);
    }
}

#[test]
fn sizes_around_nothing_and_a_workgroup() {
    let (mut gpu, stages) = stages();
    for count in [1, 2, 3, 4, 5, 255, 256, 257, 258, 259, 260, 513, 20_000] {
        let points = polder_io::generate::uniform(count, count as u64);
        let (case, expected) = Case::new(points.points(), &Resolution::LongerSide(2).into());
        assert_inserted(&mut gpu, &stages[count % 2], "uniform", &case, &expected);
    }
}

#[test]
fn a_recording_serves_again_and_buffers_for_less_are_refused() {
    let (mut gpu, [stages, _]) = stages();
    let points = polder_io::generate::clusters(900, 3, 1e-4, 3);
    let (case, expected) = Case::new(points.points(), &Options::default());
    let vertices = case.positions.len();
    let mesh = Mesh::new(&gpu.device, vertices).unwrap();
    let flip_buffers = stages.flips.buffers(mesh.capacity()).unwrap();
    let buffers = stages.insert.buffers(vertices, mesh.capacity()).unwrap();
    let (points, starts) = (gpu.buffer(&case.new.points), gpu.buffer(&case.new.starts));
    let (sites, freed) = (gpu.buffer(&[case.sites]), gpu.buffer(&case.shifted.freed));
    let (points, starts, sites, freed) = (points.view(), starts.view(), sites.view(), freed.view());
    let input = Input { points, starts, count: None, sites, freed };
    let flips = (&stages.flips, &flip_buffers);
    let mut recording = gpu.recording();
    stages.flips.record_start(&mut recording, &flip_buffers);
    let read = stages.insert.record(&mut recording, &mesh, flips, &buffers, input).unwrap();
    for _ in 0..3 {
        mesh.upload(&mut gpu.engine, &case.shifted.mesh, &case.positions).unwrap();
        assert_eq!(read.result(&gpu.run(&recording)).unwrap().rounds, expected.rounds);
        assert!(mesh.download(&mut gpu.engine).unwrap() == expected.mesh);
    }
    let (one_less, few_slots) = (vertices - 1, mesh.capacity() - 1);
    for (points, slots) in [(one_less, mesh.capacity()), (vertices, few_slots)] {
        let small = stages.insert.buffers(points, slots).unwrap();
        let mut recording = gpu.recording();
        assert!(stages.insert.record(&mut recording, &mesh, flips, &small, input).is_err());
        assert!(recording.is_empty());
    }
}

/// Vertices where other vertices should be: walks are lost, or go on until the certificate would fail.
#[test]
fn a_mesh_that_overlaps_does_no_harm() {
    let (mut gpu, [stages, _]) = stages();
    let points = polder_io::generate::uniform(300, 4);
    let (mut case, _) = Case::new(points.points(), &Options::default());
    let count = case.positions.len();
    for i in 0..count / 2 {
        case.positions.swap(i, (7 * i + 3) % count);
    }
    let mesh = Mesh::new(&gpu.device, count).unwrap();
    mesh.upload(&mut gpu.engine, &case.shifted.mesh, &case.positions).unwrap();
    let flip_buffers = stages.flips.buffers(mesh.capacity()).unwrap();
    let buffers = stages.insert.buffers(count, mesh.capacity()).unwrap();
    let (points, starts) = (gpu.buffer(&case.new.points), gpu.buffer(&case.new.starts));
    let (sites, freed) = (gpu.buffer(&[case.sites]), gpu.buffer(&case.shifted.freed));
    let input =
        Input { points: points.view(), starts: starts.view(), count: None, sites: sites.view(), freed: freed.view() };
    let mut recording = gpu.recording();
    stages.flips.record_start(&mut recording, &flip_buffers);
    let read = stages.insert.record(&mut recording, &mesh, (&stages.flips, &flip_buffers), &buffers, input).unwrap();
    let report = gpu.run(&recording);
    let known =
        matches!(read.result(&report), Ok(_) | Err(DualizeError::WalkLost { .. } | DualizeError::BoundExceeded { .. }));
    assert!(known);
    let positions = &case.positions;
    let left = mesh.download(&mut gpu.engine).unwrap();
    assert!(read.result(&report).is_err() || reference::certify(&left, positions, "test").is_err());
}
