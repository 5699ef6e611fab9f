//! Flips on the device against their reference, slot by slot.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use glam::DVec2;
use polder_flip::gpu::{Arithmetic, Buffers, EdgeList, Mesh, Stage, Tally};
use polder_flip::reference::{self, Active};
use polder_flip::{FlipReport, priority};
use polder_mesh::{GHOST, GhostMesh, NONE};
use polder_tests::{families, point_families};
use vulkan_support::Gpu;

/// A device, and the stage by both arithmetics.
fn stages() -> (Gpu, Vec<Stage>) {
    let gpu = Gpu::open();
    let stage = |arithmetic| Stage::with_arithmetic(&gpu.device, arithmetic).unwrap();
    let stages = vec![stage(Arithmetic::Filtered), stage(Arithmetic::Integers)];
    (gpu, stages)
}

/// A mesh on the device, and what the stage needs beside it.
struct Uploaded {
    mesh: Mesh,
    buffers: Buffers,
    tally: Tally,
}

impl Uploaded {
    fn new(gpu: &mut Gpu, stage: &Stage, start: &GhostMesh, positions: &[DVec2]) -> Self {
        let mesh = Mesh::with_slots(&gpu.device, positions.len(), start.slots()).unwrap();
        mesh.upload(&mut gpu.engine, start, positions).unwrap();
        let buffers = stage.buffers(start.slots()).unwrap();
        Self { mesh, buffers, tally: Tally::new(&gpu.device).unwrap() }
    }

    fn holds(&self, gpu: &mut Gpu, expected: &GhostMesh) -> bool {
        self.mesh.download(&mut gpu.engine).unwrap() == *expected
    }
}

fn assert_flipped(gpu: &mut Gpu, stage: &Stage, name: &str, start: &GhostMesh, positions: &[DVec2]) -> FlipReport {
    let on = Uploaded::new(gpu, stage, start, positions);
    let mut recording = gpu.recording();
    stage.record_start(&mut recording, &on.buffers);
    on.tally.record_clear(&mut recording);
    stage.record_flip(&mut recording, &on.mesh, &on.buffers, &on.tally).unwrap();
    let read = on.tally.read(&mut recording);
    let report = read.report(&gpu.run(&recording));
    let mut expected = start.clone();
    let expected_report = reference::flip(&mut expected, positions).unwrap();
    assert_eq!(report, expected_report, "{name}");
    assert!(on.holds(gpu, &expected), "{name}");
    report
}

/// A start that is far from Delaunay.
fn swept(points: &[DVec2]) -> GhostMesh {
    reference::sweep(points).unwrap().0
}

/// Constrains some finite edges, the same on every run.
fn constrain_some(mesh: &mut GhostMesh) {
    for h in 0..3 * mesh.slots() as u32 {
        let ends = [mesh.origin(h), mesh.destination(h)];
        if mesh.twin(h) != NONE && !ends.contains(&GHOST) && priority(h).is_multiple_of(5) {
            mesh.set_constrained(h, true);
        }
    }
}

fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list.dedup();
    list
}

#[test]
fn every_family_from_thin_triangles() {
    let (mut gpu, stages) = stages();
    for (name, pslg) in families(300, 11) {
        let mut start = swept(pslg.points());
        for stage in &stages {
            assert_flipped(&mut gpu, stage, name, &start, pslg.points());
        }
        constrain_some(&mut start);
        assert_flipped(&mut gpu, &stages[0], name, &start, pslg.points());
    }
}

#[test]
fn every_family_as_stage_4_leaves_it() {
    let (mut gpu, stages) = stages();
    for (name, pslg) in families(3000, 12) {
        let Ok(Some(through)) = polder::stages(&pslg, &polder::Options::default()) else { continue };
        assert_flipped(&mut gpu, &stages[0], name, &through.constrained, &through.positions);
    }
}

#[test]
fn sizes_around_nothing_and_a_workgroup() {
    let (mut gpu, stages) = stages();
    for count in [0, 1, 2, 3, 4, 43, 44, 86, 87, 128, 129, 700, 5000] {
        let points = polder_io::generate::uniform(count, count as u64);
        let report = assert_flipped(&mut gpu, &stages[count % 2], "uniform", &swept(points.points()), points.points());
        assert_eq!(report.rounds == 0, count < 2);
    }
}

#[test]
fn a_mesh_of_free_slots_alone() {
    let (mut gpu, stages) = stages();
    assert_flipped(&mut gpu, &stages[0], "free", &GhostMesh::with_slots(40), &[DVec2::ZERO]);
}

/// Lists as stage 4 makes them: from either side, no edge twice.
#[test]
fn rounds_one_by_one() {
    let (mut gpu, stages) = stages();
    for (turn, (name, pslg)) in point_families(250, 13).into_iter().enumerate() {
        let stage = &stages[turn % 2];
        let mut expected = swept(pslg.points());
        expected.triangles.extend([[polder_mesh::DELETED; 3]; 5]);
        expected.links.extend([[NONE; 3]; 5]);
        expected.constrained.extend([0; 5]);
        let on = Uploaded::new(&mut gpu, stage, &expected, pslg.points());
        let mut edges: Vec<u32> =
            (0..3 * expected.slots() as u32).filter(|&h| !priority(h ^ 3).is_multiple_of(3)).collect();
        edges.retain(|&h| expected.twin(h) != NONE);
        edges.sort_by_key(|&h| (h.min(expected.twin(h)), priority(h)));
        edges.dedup_by_key(|h| (*h).min(expected.twin(*h)));
        edges.sort_by_key(|&h| priority(h ^ 8));
        let list = EdgeList::new(&gpu.device, edges.len().max(3 * expected.slots())).unwrap();
        let mut active = Active::new();
        edges.iter().for_each(|&h| active.push(h));
        let mut recording = gpu.recording();
        stage.record_start(&mut recording, &on.buffers);
        gpu.run(&recording);
        for _ in 0..4 {
            let edges = sorted(active.half_edges().iter().map(|&h| h.min(expected.twin(h))).collect());
            gpu.engine.upload(list.count(), &[edges.len() as u32, 0, 0, 0, 0, 0, 0, 0]).unwrap();
            gpu.engine.upload(list.edges().slice(0..edges.len()).unwrap(), &edges).unwrap();
            let mut recording = gpu.recording();
            on.tally.record_clear(&mut recording);
            stage.record_round(&mut recording, &on.mesh, &on.buffers, &list, &on.tally, None).unwrap();
            let read = on.tally.read(&mut recording);
            let report = read.report(&gpu.run(&recording));
            let (tests, rounds) = (active.tests(), u64::from(!active.is_empty()));
            let flips = reference::flip_round(&mut expected, pslg.points(), &mut active);
            let tests = active.tests() - tests;
            assert_eq!(report, FlipReport { rounds, flips, tests }, "{name}");
            assert!(on.holds(&mut gpu, &expected), "{name}");
            assert_eq!(gpu.fetch(list.count())[0], 0, "{name}: the list is emptied");
        }
    }
}

#[test]
fn hulls_are_closed() {
    let (mut gpu, stages) = stages();
    for (turn, (name, pslg)) in point_families(400, 14).into_iter().enumerate() {
        let stage = &stages[turn % 2];
        let order: Vec<u32> = {
            let at = |v: u32| pslg.points()[v as usize] + 0.0;
            let mut order: Vec<u32> = (0..pslg.points().len() as u32).collect();
            order.sort_by(|&a, &b| polder_predicates::lexicographic(at(a), at(b)));
            order.dedup_by(|b, a| at(*a) == at(*b));
            order
        };
        let start = reference::chain(&order);
        let mut expected = start.clone();
        let expected_report = reference::close_hull(&mut expected, pslg.points()).unwrap();
        // Over all ghost edges, and over a list of them.
        for given in [false, true] {
            let on = Uploaded::new(&mut gpu, stage, &start, pslg.points());
            let edges: Vec<u32> = (0..3 * start.slots() as u32).rev().collect();
            let list = EdgeList::new(&gpu.device, edges.len()).unwrap();
            gpu.engine.upload(list.count(), &[edges.len() as u32, 0, 0, 0, 0, 0, 0, 0]).unwrap();
            gpu.engine.upload(list.edges(), &edges).unwrap();
            let mut recording = gpu.recording();
            stage.record_start(&mut recording, &on.buffers);
            on.tally.record_clear(&mut recording);
            let list = given.then_some((&list, 5 * (turn % 2)));
            stage.record_close_hull(&mut recording, &on.mesh, &on.buffers, list, &on.tally).unwrap();
            let read = on.tally.read(&mut recording);
            let report = gpu.run(&recording);
            assert_eq!((read.report(&report), report.waits), (expected_report, 1), "{name}");
            assert!(on.holds(&mut gpu, &expected), "{name}");
        }
    }
}

#[test]
fn a_recording_serves_again_and_buffers_for_less_are_refused() {
    let (mut gpu, stages) = stages();
    let points = polder_io::generate::gaussian(2000, 3);
    let start = swept(points.points());
    let on = Uploaded::new(&mut gpu, &stages[0], &start, points.points());
    let mut recording = gpu.recording();
    stages[0].record_start(&mut recording, &on.buffers);
    on.tally.record_clear(&mut recording);
    stages[0].record_flip(&mut recording, &on.mesh, &on.buffers, &on.tally).unwrap();
    let read = on.tally.read(&mut recording);
    let mut reports = Vec::new();
    for _ in 0..3 {
        on.mesh.upload(&mut gpu.engine, &start, points.points()).unwrap();
        reports.push(read.report(&gpu.run(&recording)));
    }
    assert!(reports[0] == reports[1] && reports[1] == reports[2]);
    let small = stages[0].buffers(start.slots() - 1).unwrap();
    let mut recording = gpu.recording();
    assert!(stages[0].record_flip(&mut recording, &on.mesh, &small, &on.tally).is_err());
    assert!(recording.is_empty());
    let too_few = Mesh::with_slots(&gpu.device, points.points().len(), start.slots() - 1).unwrap();
    assert!(too_few.upload(&mut gpu.engine, &start, points.points()).is_err());
    assert!(on.mesh.upload(&mut gpu.engine, &start, &points.points()[1..]).is_err());
}
