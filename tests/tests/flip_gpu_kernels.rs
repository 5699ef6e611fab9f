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
            edges = kernels::relink_edges(&mut mesh, &scratch, &illegal);
        }
        cases.push(Case { name: name.to_owned(), positions, mesh, scratch, edges });
    }
    cases
}

/// A case on the device.
struct Uploaded {
    mesh: Mesh,
    claims: Buffer<u32>,
    list: Buffer<u32>,
    list_count: Buffer<u32>,
    out: Buffer<u32>,
    listed: Buffer<u32>,
    words: Buffer<u32>,
    report: Buffer<u32>,
}

/// Integers behind the f64 filter.
const EXACT: &[(&str, u32)] = &[("ARITHMETIC", 1)];
/// Places of the words that steer rounds: illegal edges at 0 for even rounds and at 4 for odd ones.
const TAKEN: usize = 8;
const ROUND: usize = 9;
const ROUND_NOW: usize = 10;
const ANY_TESTED: usize = 11;
const LISTED: usize = 12;
const PENDING: usize = 16;

impl Uploaded {
    fn new(gpu: &mut Gpu, case: &Case, list: &[u32], words: &[(usize, u32)]) -> Self {
        let slots = case.mesh.slots();
        let mesh = Mesh::with_slots(&gpu.device, case.positions.len(), slots).unwrap();
        mesh.upload(&mut gpu.engine, &case.mesh, &case.positions).unwrap();
        let mut records = gpu.fetch(mesh.records());
        records.iter_mut().zip(&case.scratch.stamps).for_each(|(record, &stamp)| record[7] = stamp);
        gpu.engine.upload(mesh.records(), &records).unwrap();
        let mut all = [0; 20];
        all[ROUND] = case.scratch.round;
        words.iter().for_each(|&(place, word)| all[place] = word);
        let room = list.len().max(6 * slots) + 4;
        let mut padded = list.to_vec();
        padded.resize(room, 7);
        Self {
            mesh,
            claims: gpu.buffer(&case.scratch.claims),
            list: gpu.buffer(&padded),
            list_count: gpu.buffer(&[list.len() as u32]),
            out: gpu.buffer(&vec![7; room]),
            listed: gpu.buffer(&vec![0; 3 * slots / 32 + 1]),
            words: gpu.buffer(&all),
            report: gpu.buffer(&[0; 8]),
        }
    }

    fn word(&self, gpu: &mut Gpu, word: usize) -> u32 {
        gpu.fetch(self.words.view())[word]
    }

    fn report(&self, gpu: &mut Gpu) -> [u64; 3] {
        let words = gpu.fetch(self.report.view());
        assert_eq!((words[2], words[4]), (0, 0));
        [words[0], words[1], words[3]].map(u64::from)
    }

    /// The first of a list, whose order is that of arrival.
    fn sorted(&self, gpu: &mut Gpu, list: &Buffer<u32>, count: usize) -> Vec<[u32; 2]> {
        sorted(gpu.fetch(list.view().cast())[..count].to_vec())
    }

    /// Whether claims and stamps are these.
    fn notes(&self, gpu: &mut Gpu, scratch: &Scratch) -> bool {
        let stamps: Vec<u32> = gpu.fetch(self.mesh.records()).iter().map(|record| record[7]).collect();
        gpu.fetch(self.claims.view()) == scratch.claims && stamps == scratch.stamps
    }
}

fn run<S: Shader>(gpu: &mut Gpu, constants: &[(&'static str, u32)], groups: u32, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, [groups, 1, 1], arguments);
    gpu.run(&recording);
}

fn sorted(mut list: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
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
fn test_mesh() {
    let mut gpu = Gpu::open();
    for (turn, case) in cases().iter().enumerate() {
        for (scope, parity) in [(0, turn as u32 % 2), (1, 0)] {
            let mut scratch = case.scratch.clone();
            let (expected, tests) = kernels::test_mesh(&case.mesh, &case.positions, scope == 1, &mut scratch);
            let on = Uploaded::new(&mut gpu, case, &[], &[]);
            let arguments = TestMeshArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                claims: on.claims.view(),
                illegal: on.out.view().cast(),
                words: on.words.view(),
                report: on.report.view(),
                slots: on.mesh.slots(),
                scope,
                parity,
            };
            let groups = case.mesh.slots().div_ceil(256) as u32;
            run::<TestMesh>(&mut gpu, EXACT, groups + 1, &arguments);
            let count = on.word(&mut gpu, 4 * parity as usize) as usize;
            assert_eq!(on.sorted(&mut gpu, &on.out, count), sorted(expected), "{}", case.name);
            assert!(on.notes(&mut gpu, &scratch), "{}", case.name);
            let rounds = u64::from(tests != 0);
            assert_eq!(on.report(&mut gpu), [rounds, 0, tests], "{}", case.name);
            assert_eq!(u64::from(on.word(&mut gpu, ANY_TESTED)), rounds);
        }
    }
}

#[test]
fn test_edges() {
    let mut gpu = Gpu::open();
    for (turn, case) in cases().iter().enumerate() {
        let hull_alone = turn % 3 == 0;
        let mut scratch = case.scratch.clone();
        let (expected, tests) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, hull_alone, &mut scratch);
        let other_sides = case.edges.iter().enumerate().map(|(i, &h)| if i % 3 == 0 { case.mesh.twin(h) } else { h });
        let lists = [case.edges.clone(), other_sides.collect(), shuffled(&case.mesh, &case.edges)];
        for (list, repeats) in lists.into_iter().zip([false, false, true]) {
            let on = Uploaded::new(&mut gpu, case, &list, &[]);
            let arguments = TestEdgesArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                edges: on.list.view(),
                edge_count: on.list_count.view(),
                listed: repeats.then(|| on.listed.view()),
                claims: on.claims.view(),
                illegal: on.out.view().cast(),
                words: on.words.view(),
                report: on.report.view(),
                limit: list.len() as u32,
                scope: u32::from(hull_alone),
                parity: 1,
            };
            run::<TestEdges>(&mut gpu, EXACT, 3, &arguments);
            let count = on.word(&mut gpu, 4) as usize;
            assert_eq!(on.sorted(&mut gpu, &on.out, count), sorted(expected.clone()), "{}", case.name);
            assert!(on.notes(&mut gpu, &scratch), "{}", case.name);
            let rounds = u64::from(!list.is_empty());
            assert_eq!(on.report(&mut gpu), [rounds, 0, tests], "{}", case.name);
            assert_eq!(on.word(&mut gpu, LISTED), list.len() as u32);
        }
    }
}

#[test]
fn flip_edges() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        let (illegal, _) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, false, &mut case.scratch);
        let words = [(4, illegal.len() as u32), (LISTED, 1), (ANY_TESTED, 1)];
        let on = Uploaded::new(&mut gpu, case, illegal.as_flattened(), &words);
        let bits = vec![u32::MAX; 3 * case.mesh.slots() / 32 + 1];
        gpu.engine.upload(on.listed.view(), &bits).unwrap();
        let tested = gpu.buffer(&[3_u32, 9]);
        let arguments = FlipEdgesArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            claims: on.claims.view(),
            illegal: on.list.view().cast(),
            edges: Some(tested.view()),
            edge_count: Some(on.list_count.view()),
            listed: Some(on.listed.view()),
            words: on.words.view(),
            report: on.report.view(),
            limit: 2,
            least: illegal.len() as u32 + 1,
            parity: 1,
        };
        // Too few: then there is nothing to do.
        run::<FlipEdges>(&mut gpu, &[], 2, &arguments);
        assert_eq!(on.word(&mut gpu, TAKEN), 0, "{}", case.name);
        assert!(on.notes(&mut gpu, &case.scratch), "{}", case.name);
        assert_eq!(on.word(&mut gpu, 4), illegal.len() as u32);
        run::<FlipEdges>(&mut gpu, &[], 2, &FlipEdgesArgs { least: illegal.len() as u32, ..arguments });
        let mut expected = illegal.clone();
        let flips = kernels::flip_edges(&mut case.mesh, &mut case.scratch, &mut expected);
        assert_eq!(gpu.fetch(on.list.view().cast::<[u32; 2]>())[..expected.len()], expected, "{}", case.name);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
        assert!(on.notes(&mut gpu, &case.scratch), "{}", case.name);
        assert_eq!(on.report(&mut gpu), [0, flips, 0], "{}", case.name);
        let words = gpu.fetch(on.words.view());
        assert_eq!([words[TAKEN], words[ROUND_NOW]], [expected.len() as u32, case.scratch.round]);
        assert_eq!(words[ANY_TESTED], 0);
        assert_eq!(gpu.fetch(on.list_count.view()), [0], "the list is emptied");
        assert_eq!(gpu.fetch(on.listed.view())[0], !(1 << 3), "the bit of the one edge that was listed");
    }
}

#[test]
fn relink_edges() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        let (mut illegal, _) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, false, &mut case.scratch);
        kernels::flip_edges(&mut case.mesh, &mut case.scratch, &mut illegal);
        let count = illegal.len() as u32;
        let on = Uploaded::new(
            &mut gpu,
            case,
            illegal.as_flattened(),
            &[(0, count), (TAKEN, count), (ROUND_NOW, case.scratch.round)],
        );
        let note = gpu.buffer(&[7_u32; 2]);
        let arguments = RelinkEdgesArgs {
            links: on.mesh.twins(),
            illegal: on.list.view().cast(),
            words: on.words.view(),
            note: Some(note.view()),
            parity: 0,
        };
        run::<RelinkEdges>(&mut gpu, &[], 2, &arguments);
        kernels::relink_edges(&mut case.mesh, &case.scratch, &illegal);
        assert!(illegal.iter().all(|[h, _]| h & WON == 0) || case.mesh.check().is_ok(), "{}", case.name);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
        assert!(on.notes(&mut gpu, &case.scratch), "{}", case.name);
        assert!(case.scratch.claims.iter().all(|&claim| claim == NONE), "{}", case.name);
        assert_eq!([on.word(&mut gpu, 0), on.word(&mut gpu, ROUND)], [0, case.scratch.round]);
        assert_eq!(gpu.fetch(note.view()), [0, count], "{}", case.name);
    }
}

#[test]
fn advance_edges() {
    let mut gpu = Gpu::open();
    for (turn, case) in cases().iter_mut().enumerate() {
        let hull_alone = turn % 3 == 2;
        let (mut illegal, _) =
            kernels::test_edges(&case.mesh, &case.positions, &case.edges, hull_alone, &mut case.scratch);
        kernels::flip_edges(&mut case.mesh, &mut case.scratch, &mut illegal);
        let count = illegal.len() as u32;
        let parity = turn as u32 % 2;
        let words = [(4 * parity as usize, count), (TAKEN, count), (ROUND_NOW, case.scratch.round)];
        let on = Uploaded::new(&mut gpu, case, illegal.as_flattened(), &words);
        let arguments = AdvanceEdgesArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            claims: on.claims.view(),
            illegal: on.list.view().cast(),
            next_illegal: on.out.view().cast(),
            words: on.words.view(),
            report: on.report.view(),
            scope: u32::from(hull_alone),
            parity,
        };
        run::<AdvanceEdges>(&mut gpu, EXACT, 2, &arguments);
        let (next, tests) =
            kernels::advance_edges(&mut case.mesh, &case.positions, &illegal, hull_alone, &mut case.scratch);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
        assert!(on.notes(&mut gpu, &case.scratch), "{}", case.name);
        assert_eq!(on.sorted(&mut gpu, &on.out, next.len()), sorted(next.clone()), "{}", case.name);
        assert_eq!(on.report(&mut gpu), [u64::from(count != 0), 0, tests], "{}", case.name);
        let counts = [parity, 1 - parity].map(|parity| on.word(&mut gpu, 4 * parity as usize));
        assert_eq!(counts, [0, next.len() as u32], "{}", case.name);
    }
}

#[test]
fn flip_tail() {
    let mut gpu = Gpu::open();
    for case in &mut cases() {
        let (mut illegal, _) = kernels::test_edges(&case.mesh, &case.positions, &case.edges, false, &mut case.scratch);
        for (turn, [least, most]) in [[usize::MAX, 3], [20, 100], [usize::MAX, 0], [9, 2]].into_iter().enumerate() {
            let parity = turn % 2;
            let words = [(4 * parity, illegal.len() as u32), (PENDING, 99)];
            let on = Uploaded::new(&mut gpu, case, illegal.as_flattened(), &words);
            let lists = [[&on.list, &on.out], [&on.out, &on.list]][parity];
            let arguments = FlipTailArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                claims: on.claims.view(),
                illegal_0: lists[0].view().cast(),
                illegal_1: lists[1].view().cast(),
                words: on.words.view(),
                report: on.report.view(),
                scope: 0,
                least: least as u32,
                most: most as u32,
                most_flips: u32::MAX,
            };
            run::<FlipTail>(&mut gpu, EXACT, 1, &arguments);
            let limits = [least, most];
            let (left, report) =
                kernels::flip_tail(&mut case.mesh, &case.positions, &illegal, false, limits, &mut case.scratch);
            assert!(on.mesh.download(&mut gpu.engine).unwrap() == case.mesh, "{}", case.name);
            assert_eq!(on.report(&mut gpu), [report.rounds, report.flips, report.tests], "{}", case.name);
            assert_eq!(on.word(&mut gpu, ROUND), case.scratch.round, "{}", case.name);
            assert_eq!(on.word(&mut gpu, PENDING), left.len() as u32, "{}", case.name);
            let ended = (parity + report.rounds as usize) % 2;
            if !left.is_empty() {
                assert_eq!(on.word(&mut gpu, 4 * ended), left.len() as u32, "{}", case.name);
                assert_eq!(on.sorted(&mut gpu, lists[ended], left.len()), sorted(left.clone()), "{}", case.name);
            }
            assert_eq!(on.word(&mut gpu, 4 * (1 - ended)), 0, "{}", case.name);
            assert!(on.notes(&mut gpu, &case.scratch), "{}", case.name);
            illegal = left;
        }
    }
}
