//! Each kernel of stage 5 against the reference of its name.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use glam::DVec2;
use polder_flip::gpu::Mesh;
use polder_flip::kernels::*;
use polder_flip::reference::kernels::{self, Scratch, WON};
use polder_mesh::{GhostMesh, NONE};
use polder_tests::families;
use polder_vulkan::{Buffer, Kernel, Shader};
use vulkan_support::Gpu;

/// A mesh that is some rounds into being flipped, what kernels keep, and the edges of the next round.
struct Case {
    name: String,
    positions: Vec<DVec2>,
    mesh: GhostMesh,
    scratch: Scratch,
    edges: Vec<u32>,
}

/// Every family, swept, after some rounds; a part of the edges is constrained.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (turn, (name, pslg)) in families(200, 5).into_iter().enumerate() {
        let positions = pslg.points().to_vec();
        let (mut mesh, _) = polder_flip::reference::sweep(&positions).unwrap();
        if turn % 2 == 1 {
            for h in (0..3 * mesh.slots() as u32).filter(|h| h % 11 == 0) {
                if mesh.origin(h) < NONE - 1 && mesh.destination(h) < NONE - 1 {
                    mesh.set_constrained(h, true);
                }
            }
        }
        let mut scratch = Scratch::new(mesh.slots());
        let mut edges: Vec<u32> = (0..3 * mesh.slots() as u32).filter(|&h| h < mesh.twin(h)).collect();
        for _ in 0..turn % 4 {
            let (mut illegal, _) = kernels::test_edges(&mesh, &positions, &edges, false, &mut scratch);
            kernels::flip_edges(&mut mesh, &mut scratch, &mut illegal);
            edges = kernels::relink_edges(&mut mesh, &mut scratch, &illegal);
        }
        cases.push(Case { name: name.to_owned(), positions, mesh, scratch, edges });
    }
    cases
}

/// A case on the device.
struct Uploaded {
    mesh: Mesh,
    claims: Buffer<u32>,
    stamps: Buffer<u32>,
    list: Buffer<u32>,
    list_count: Buffer<u32>,
    out: Buffer<u32>,
    deferred: Buffer<u32>,
    listed: Buffer<u32>,
    words: Buffer<u32>,
    report: Buffer<u32>,
}

const WORD_TAKEN: usize = 0;
const WORD_ILLEGAL: usize = 1;
const WORD_RELINK: usize = 2;
const WORD_DEFERRED: usize = 3;
const WORD_ROUND: usize = 4;

impl Uploaded {
    fn new(gpu: &mut Gpu, case: &Case, list: &[u32]) -> Self {
        let slots = case.mesh.slots();
        let mesh = Mesh::with_slots(&gpu.device, case.positions.len(), slots).unwrap();
        mesh.upload(&mut gpu.engine, &case.mesh, &case.positions).unwrap();
        let mut words = [0; 8];
        words[WORD_ROUND] = case.scratch.round;
        let mut padded = list.to_vec();
        padded.resize(list.len().max(3 * slots) + 1, 7);
        Self {
            mesh,
            claims: gpu.buffer(&case.scratch.claims),
            stamps: gpu.buffer(&case.scratch.stamps),
            list: gpu.buffer(&padded),
            list_count: gpu.buffer(&[list.len() as u32]),
            out: gpu.buffer(&vec![7; 3 * slots + 1]),
            deferred: gpu.buffer(&vec![7; 3 * slots + 4]),
            listed: gpu.buffer(&vec![0; 3 * slots / 32 + 1]),
            words: gpu.buffer(&words),
            report: gpu.buffer(&[0; 8]),
        }
    }

    fn word(&self, gpu: &mut Gpu, word: usize) -> usize {
        gpu.fetch(self.words.view())[word] as usize
    }

    fn report(&self, gpu: &mut Gpu) -> [u32; 3] {
        let words = gpu.fetch(self.report.view());
        assert_eq!((words[2], words[4]), (0, 0));
        [words[0], words[1], words[3]]
    }

    /// The first of a list, whose order is that of arrival.
    fn sorted(&self, gpu: &mut Gpu, list: &Buffer<u32>, count: usize) -> Vec<u32> {
        let mut found = gpu.fetch(list.view())[..count].to_vec();
        found.sort_unstable();
        found
    }
}

fn run<S: Shader>(gpu: &mut Gpu, constants: &[(&'static str, u32)], groups: u32, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, [groups, 1, 1], arguments);
    gpu.run(&recording);
}

fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list
}

/// Edges from both sides, some repeatedly.
fn shuffled(mesh: &GhostMesh, edges: &[u32]) -> Vec<u32> {
    let mut list: Vec<u32> = edges.iter().flat_map(|&h| [h, mesh.twin(h)]).collect();
    list.extend(edges.iter().step_by(3));
    list.sort_by_key(|&h| polder_flip::priority(h));
    list
}

#[test]
fn test_edges() {
    let mut gpu = Gpu::open();
    for (turn, case) in cases().iter().enumerate() {
        let hull_alone = turn % 3 == 0;
        let mut scratch = case.scratch.clone();
        let (expected, tests) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, hull_alone, &mut scratch);
        // As they are handed on; repeated; and all edges, where those are the list.
        let all = turn % 4 == 0;
        for source in 0..if all { 3 } else { 2 } {
            let list = if source == 1 { shuffled(&case.mesh, &case.edges) } else { case.edges.clone() };
            let on = Uploaded::new(&mut gpu, case, &list);
            let arguments = TestEdgesArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                edges: (source != 2).then(|| on.list.view()),
                edge_count: (source != 2).then(|| on.list_count.view()),
                listed: (source == 1).then(|| on.listed.view()),
                claims: on.claims.view(),
                illegal: on.out.view(),
                deferred: on.deferred.view(),
                words: on.words.view(),
                report: on.report.view(),
                slots: on.mesh.slots(),
                limit: list.len() as u32,
                least: 0,
                scope: u32::from(hull_alone),
                again: 0,
            };
            // First what the filter knows, then the rest.
            run::<TestEdges>(&mut gpu, &[("ARITHMETIC", 0)], 3, &arguments);
            let again = TestEdgesArgs { edges: Some(on.deferred.view()), listed: None, again: 1, ..arguments };
            run::<TestEdges>(&mut gpu, &[("ARITHMETIC", 1)], 2, &again);
            let count = on.word(&mut gpu, WORD_ILLEGAL);
            assert_eq!(on.sorted(&mut gpu, &on.out, count), sorted(expected.clone()), "{} {source}", case.name);
            assert_eq!(gpu.fetch(on.claims.view()), scratch.claims, "{} {source}", case.name);
            assert_eq!(on.report(&mut gpu), [0, 0, tests as u32], "{} {source}", case.name);
            assert_eq!(on.word(&mut gpu, WORD_ROUND) as u32, scratch.round);
            let taken = on.word(&mut gpu, WORD_TAKEN);
            assert_eq!(taken != 0, if source == 2 { tests != 0 } else { !list.is_empty() }, "{}", case.name);
        }
    }
}

#[test]
fn flip_edges() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        let (illegal, _) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, false, &mut case.scratch);
        let on = Uploaded::new(&mut gpu, case, &illegal);
        let mut words = gpu.fetch(on.words.view());
        (words[WORD_TAKEN], words[WORD_ILLEGAL], words[WORD_DEFERRED]) = (1, illegal.len() as u32, 5);
        gpu.engine.upload(on.words.view(), &words).unwrap();
        let bits = vec![u32::MAX; 3 * case.mesh.slots() / 32 + 1];
        gpu.engine.upload(on.listed.view(), &bits).unwrap();
        let cleared = gpu.buffer(&[3_u32]);
        let arguments = FlipEdgesArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            claims: on.claims.view(),
            stamps: on.stamps.view(),
            illegal: on.list.view(),
            edge_count: on.list_count.view(),
            edges: Some(cleared.view()),
            listed: Some(on.listed.view()),
            words: on.words.view(),
            report: on.report.view(),
            limit: u32::MAX,
        };
        run::<FlipEdges>(&mut gpu, &[], 2, &arguments);
        let mut expected = illegal.clone();
        let flips = kernels::flip_edges(&mut case.mesh, &mut case.scratch, &mut expected);
        assert_eq!(gpu.fetch(on.list.view())[..expected.len()], expected, "{}", case.name);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
        assert_eq!(gpu.fetch(on.stamps.view()), case.scratch.stamps, "{}", case.name);
        assert_eq!(on.report(&mut gpu), [1, flips as u32, 0], "{}", case.name);
        assert_eq!(on.word(&mut gpu, WORD_RELINK), expected.len());
        assert_eq!((on.word(&mut gpu, WORD_DEFERRED), gpu.fetch(on.list_count.view())), (0, vec![0]));
        assert_eq!(gpu.fetch(on.listed.view())[0], !(1 << 3), "the bit of the one edge that was listed");
    }
}

#[test]
fn relink_edges() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        let (mut illegal, _) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, false, &mut case.scratch);
        kernels::flip_edges(&mut case.mesh, &mut case.scratch, &mut illegal);
        let on = Uploaded::new(&mut gpu, case, &illegal);
        let mut words = gpu.fetch(on.words.view());
        words[WORD_RELINK] = illegal.len() as u32;
        words[WORD_ILLEGAL] = illegal.len() as u32;
        gpu.engine.upload(on.words.view(), &words).unwrap();
        gpu.engine.upload(on.list_count.view(), &[0]).unwrap();
        let also_count = gpu.buffer(&[2_u32]);
        let arguments = RelinkEdgesArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            claims: on.claims.view(),
            stamps: on.stamps.view(),
            illegal: on.list.view(),
            edges: on.out.view(),
            edge_count: on.list_count.view(),
            also: Some(on.deferred.view()),
            also_count: Some(also_count.view()),
            words: on.words.view(),
            also_limit: on.deferred.len() as u32,
        };
        run::<RelinkEdges>(&mut gpu, &[], 2, &arguments);
        let expected = kernels::relink_edges(&mut case.mesh, &mut case.scratch, &illegal);
        assert!(illegal.iter().all(|h| h & WON == 0) || case.mesh.check().is_ok(), "{}", case.name);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
        assert_eq!(gpu.fetch(on.claims.view()), vec![NONE; case.mesh.slots()], "{}", case.name);
        let count = gpu.fetch(on.list_count.view())[0] as usize;
        assert_eq!(on.sorted(&mut gpu, &on.out, count), sorted(expected.clone()), "{}", case.name);
        assert_eq!(gpu.fetch(also_count.view()), [2 + count as u32]);
        let also = gpu.fetch(on.deferred.view())[2..2 + count].to_vec();
        assert_eq!(sorted(also), sorted(expected), "{}", case.name);
        assert_eq!(on.word(&mut gpu, WORD_ILLEGAL), 0);
    }
}

#[test]
fn flip_tail() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        for [least, most] in [[usize::MAX, 3], [20, 100], [usize::MAX, 0]] {
            let edges = case.edges.clone();
            let on = Uploaded::new(&mut gpu, case, &edges);
            let arguments = FlipTailArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                edges: on.list.view(),
                edge_count: on.list_count.view(),
                also: None,
                also_count: None,
                illegal: on.out.view(),
                claims: on.claims.view(),
                stamps: on.stamps.view(),
                words: on.words.view(),
                report: on.report.view(),
                scope: 0,
                least: least as u32,
                most: most as u32,
                most_tests: u32::MAX,
                also_limit: 0,
            };
            run::<FlipTail>(&mut gpu, &[("ARITHMETIC", 1)], 1, &arguments);
            let (left, report) =
                kernels::flip_tail(&mut case.mesh, &case.positions, &edges, false, [least, most], &mut case.scratch);
            assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
            let count = gpu.fetch(on.list_count.view())[0] as usize;
            assert_eq!(on.sorted(&mut gpu, &on.list, count), sorted(left.clone()), "{}", case.name);
            let counts = [report.rounds, report.flips, report.tests].map(|count| count as u32);
            assert_eq!(on.report(&mut gpu), counts, "{}", case.name);
            assert_eq!(on.word(&mut gpu, WORD_ROUND) as u32, case.scratch.round, "{}", case.name);
            assert_eq!(gpu.fetch(on.stamps.view()), case.scratch.stamps, "{}", case.name);
            case.edges = left;
        }
    }
}
