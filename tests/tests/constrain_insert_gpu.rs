//! Insertion of sub-constraints on the device against its reference, slot by slot.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../../crates/polder-constrain/tests/common/bad_case.rs"]
mod bad_case;
mod constrain_support;
#[path = "../../crates/polder-constrain/tests/common/diagonals.rs"]
mod diagonals;
mod random_support;
mod vulkan_support;

use constrain_support::Start;
use glam::DVec2;
use polder_constrain::gpu::insert::{Counts, Input, Rounds, Stage};
use polder_constrain::gpu::pieces::{self, Grid};
use polder_constrain::reference::{self, Insertion, LONGEST_REBUILT};
use polder_constrain::{ConstrainError, Fault, InsertReport};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_mesh::GhostMesh;
use polder_tests::families;
use vulkan_support::Gpu;

/// A device, and the stage by both arithmetics.
fn stages() -> (Gpu, Vec<Stage>) {
    let gpu = Gpu::open();
    let stage = |arithmetic| Stage::with_arithmetic(&gpu.device, arithmetic).unwrap();
    let stages = vec![stage(Arithmetic::Filtered), stage(Arithmetic::Integers)];
    (gpu, stages)
}

/// Room for pieces of walks.
const PIECES: usize = 4096;

struct Case<'a> {
    mesh: &'a GhostMesh,
    positions: &'a [DVec2],
    sub_constraints: &'a [[u32; 2]],
}

fn run(gpu: &mut Gpu, stage: &Stage, case: &Case<'_>, rounds: Rounds) -> (Counts, GhostMesh) {
    let mesh = Mesh::with_slots(&gpu.device, case.positions.len(), case.mesh.slots()).unwrap();
    mesh.upload(&mut gpu.engine, case.mesh, case.positions).unwrap();
    let count = case.sub_constraints.len();
    // Of points that are one there may be many more than slots.
    let slots = case.mesh.slots().max(case.positions.len());
    let buffers = stage.buffers(count, PIECES, slots).unwrap();
    let sub_constraints = gpu.buffer(case.sub_constraints);
    let nothing = vec![0; case.positions.len()];
    let (spokes, degrees) = (gpu.buffer(&nothing), gpu.buffer(&nothing));
    let (spokes, degrees) = (spokes.view(), degrees.view());
    // Every other number of sub-constraints walks in pieces, and short ones.
    let (low, high) = case.positions.iter().fold((DVec2::MAX, DVec2::MIN), |(a, b), &p| (a.min(p), b.max(p)));
    let grid =
        Grid::over(low, high, case.positions.len()).with_piece_length(if count.is_multiple_of(4) { 100 } else { 300 });
    let list = pieces::Buffers::new(&gpu.device, case.positions.len(), PIECES).unwrap();
    let in_pieces = count.is_multiple_of(2) && !case.positions.is_empty();
    let pieces = in_pieces.then_some((grid, &list));
    let input = Input { sub_constraints: sub_constraints.view(), count: None, spokes, degrees, pieces };
    let mut recording = gpu.recording();
    stage.record_spokes(&mut recording, &mesh, spokes, degrees);
    if in_pieces {
        let sow = pieces::Stage::new(&gpu.device, Arithmetic::Integers).unwrap();
        sow.record_seeds(&mut recording, &mesh, spokes, grid, &list).unwrap();
    }
    let read = stage.record_rounds(&mut recording, &mesh, &buffers, input, rounds);
    let report = gpu.run(&recording);
    let counts = read.unwrap().counts(&report);
    (counts, mesh.download(&mut gpu.engine).unwrap())
}

/// What became of an insertion, and whether it ended in inner rounds.
struct Outcome {
    report: InsertReport,
    fault: Option<Fault>,
    by_flips: bool,
}

/// The device inserts what the reference does, or ends as it does.
fn assert_same(gpu: &mut Gpu, stage: &Stage, name: &str, case: &Case<'_>, rounds: Rounds) -> Outcome {
    let mut expected = case.mesh.clone();
    let mut insertion = Insertion::new(&mut expected, case.positions, case.sub_constraints).unwrap();
    insertion.set_inner_rounds(rounds.inner);
    if rounds.least == 0 {
        insertion.set_longest_rebuilt(rounds.longest);
    }
    let (mut error, mut walks) = (Ok(()), 0);
    while !insertion.is_done() && error.is_ok() {
        walks = insertion.report().outer_rounds;
        error = insertion.outer_round();
    }
    let report = insertion.report();
    let fault = error.err().map(|error| match error {
        ConstrainError::Blocked { sub_constraint, .. } => {
            Fault::Blocked(case.sub_constraints.iter().position(|s| *s == sub_constraint).unwrap() as u32)
        }
        other => panic!("{name}: {other}"),
    });
    let (counts, mesh) = run(gpu, stage, case, rounds);
    assert_eq!(counts.fault, fault, "{name}, {rounds:?}");
    assert!(mesh == expected, "{name}, {rounds:?}: {report}");
    if fault.is_none() {
        assert_eq!((counts.report, counts.inserted), (report, report.sub_constraints), "{name}, {rounds:?}");
    } else {
        assert!(counts.inserted < report.sub_constraints, "{name}, {rounds:?}");
    }
    Outcome { report, fault, by_flips: report.outer_rounds > walks }
}

/// With the chains of up to so many triangles rebuilt.
fn assert_inserted(gpu: &mut Gpu, stage: &Stage, name: &str, case: &Case<'_>, longest: u32) -> InsertReport {
    let outcome = assert_same(gpu, stage, name, case, Rounds { longest, least: 0, ..Rounds::default() });
    assert_eq!(outcome.fault, None, "{name}");
    outcome.report
}

/// Flips alone, some of both, and as it is done.
const LONGEST: [u32; 4] = [0, 3, 9, LONGEST_REBUILT];

/// Families, with all their constraints cut.
fn starts(count: usize, seed: u64) -> Vec<(&'static str, Start, Vec<[u32; 2]>)> {
    let mut starts = Vec::new();
    for (name, pslg) in families(count, seed) {
        let start = Start::stage_4(&pslg);
        let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
        let crossings = reference::crossings(&start.mesh, &start.positions, &walk, 1).unwrap();
        if crossings.pairs.is_empty() {
            starts.push((name, start, walk.sub_constraints));
        }
    }
    starts
}

#[test]
fn every_family() {
    let (mut gpu, stages) = stages();
    let mut sums = [0; 2];
    for (size, seed) in [(30, 1), (300, 2), (2000, 3)] {
        for (turn, (name, start, subs)) in starts(size, seed).iter().enumerate() {
            let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: subs };
            // Half of the numbers by either arithmetic; of large inputs, one by each.
            let step = if size < 1000 { 2 } else { 4 };
            for (which, stage) in stages.iter().enumerate() {
                for longest in LONGEST.into_iter().skip(which + turn / 2 % 2 * 2 * (step / 4)).step_by(step) {
                    let report = assert_inserted(&mut gpu, stage, name, &case, longest);
                    sums = [sums[0] + report.all_flips(), sums[1] + report.rebuilt];
                }
            }
        }
    }
    assert!(sums.iter().all(|&sum| sum > 1000), "{sums:?}");
}

/// The mesh after each inner round of the first outer one, and after each outer round.
#[test]
fn round_by_round() {
    let (mut gpu, stages) = stages();
    let mut compared = 0;
    for (turn, (name, start, subs)) in starts(700, 4).iter().enumerate() {
        let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: subs };
        let rounds = [[1, 1], [2, 1], [3, 1], [5, 1], [1, 2], [1, 3], [2, 4], [8, 2], [3, 5]];
        for (i, [inner, outer]) in rounds.into_iter().enumerate() {
            let longest = LONGEST[(turn + i) % 4];
            let mut expected = start.mesh.clone();
            let mut insertion = Insertion::new(&mut expected, &start.positions, subs).unwrap();
            insertion.set_inner_rounds(inner);
            insertion.set_longest_rebuilt(longest);
            for _ in 0..outer {
                if !insertion.is_done() {
                    insertion.outer_round().unwrap();
                }
            }
            if insertion.is_done() {
                continue;
            }
            let report = insertion.report();
            let (counts, mesh) = run(&mut gpu, &stages[turn % 2], &case, Rounds { inner, outer, longest, least: 0 });
            assert_eq!(counts.report, report, "{name}: {inner} {outer} {longest}");
            assert!(mesh == expected, "{name}: {inner} {outer} {longest}");
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}

/// Crossing constraints end as blocked, in the same round and by the same sub-constraint as in the reference.
#[test]
fn crossings_end_as_blocked() {
    let (mut gpu, stages) = stages();
    let mut blocked = 0;
    for seed in 0..8 {
        let pslg = polder_io::generate::crossing_segments(200, 10 + 10 * seed as usize, 0.3, seed);
        let start = Start::stage_4(&pslg);
        let subs = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap().sub_constraints;
        let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &subs };
        let outcome = assert_same(&mut gpu, &stages[seed as usize % 2], "crossing", &case, Rounds::default());
        blocked += u32::from(outcome.fault.is_some());
    }
    assert!(blocked > 4, "{blocked}");
}

/// Met when a constrained edge would be flipped away.
#[test]
fn crossings_end_as_blocked_by_flips() {
    let (mut gpu, stages) = stages();
    let mut by_flips = 0;
    for seed in 0..24 {
        let mut start = Start::delaunay(&polder_io::generate::uniform(100, seed));
        start.constraints = diagonals::with_diagonals(&start.mesh, &start.positions, [0, 99]);
        let mut subs = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap().sub_constraints;
        for inner in 1..4 {
            subs.rotate_left(1);
            let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &subs };
            let rounds = Rounds { inner, longest: 0, least: 0, ..Rounds::default() };
            let outcome = assert_same(&mut gpu, &stages[seed as usize % 2], "diagonals", &case, rounds);
            by_flips += u32::from(outcome.fault.is_some() && outcome.by_flips);
        }
    }
    assert!(by_flips > 2, "{by_flips}");
}

fn assert_random(gpu: &mut Gpu, stages: &[Stage], seed: u64, most: usize) -> Option<Outcome> {
    let start = Start::stage_4(&polder_tests::random(seed, most));
    // None if all points lie on a line.
    let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).ok()?;
    let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &walk.sub_constraints };
    let longest = LONGEST[seed as usize % 4];
    let rounds = Rounds { inner: 1 + (seed / 4 % 10) as u32, longest, least: 0, ..Rounds::default() };
    Some(assert_same(gpu, &stages[seed as usize % 2], &format!("random({seed}, {most})"), &case, rounds))
}

#[test]
fn random_inputs() {
    let (mut gpu, stages) = stages();
    let outcomes: Vec<_> = (0..32).filter_map(|seed| assert_random(&mut gpu, &stages, seed, 300)).collect();
    let faults = outcomes.iter().filter(|outcome| outcome.fault.is_some()).count();
    assert!(faults > 9 && outcomes.len() > faults + 9, "{faults} of {}", outcomes.len());
}

#[test]
#[ignore = "long"]
fn many_random_inputs() {
    let (mut gpu, stages) = stages();
    random_support::many(|seed, most| _ = assert_random(&mut gpu, &stages, seed, most));
}

/// Sub-constraints may come in any order and repeatedly: constrained Delaunay triangulations do not tell.
#[test]
fn any_order_gives_one_flipped_mesh() {
    let (mut gpu, stages) = stages();
    for (turn, (name, start, subs)) in starts(250, 6).iter().enumerate() {
        let mut expected = None;
        for order in 0..3 {
            let mut subs = subs.clone();
            if order > 0 {
                subs.extend(subs.clone().iter().step_by(3));
                subs.sort_by_key(|s| polder_flip::priority(s[0].wrapping_mul(977) ^ s[1] ^ order));
            }
            let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &subs };
            let (counts, mut mesh) = run(&mut gpu, &stages[turn % 2], &case, Rounds { least: 0, ..Rounds::default() });
            assert_eq!((counts.inserted, counts.fault), (subs.len() as u64, None), "{name}");
            polder_flip::reference::flip(&mut mesh, &start.positions).unwrap();
            let names: Vec<u32> = (0..start.positions.len() as u32).collect();
            let parts = polder_mesh::Parts { representatives: names.clone(), chains: Default::default() };
            let digest = polder_mesh::Triangulation::from_mesh(&mesh, &names, parts).digest();
            assert_eq!(*expected.get_or_insert(digest), digest, "{name}");
        }
    }
}

#[test]
fn sizes_around_nothing_and_a_workgroup() {
    let (mut gpu, stages) = stages();
    for count in [0usize, 1, 2, 3, 255, 256, 257, 700] {
        let start = Start::stage_4(&polder_io::generate::segments((4 * count).max(3), count, 3));
        let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
        let subs = walk.sub_constraints;
        let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &subs };
        for longest in LONGEST {
            assert_inserted(&mut gpu, &stages[count % 2], "segments", &case, longest);
        }
    }
}

#[test]
fn buffers_for_less_are_refused() {
    let (mut gpu, stages) = stages();
    let start = Start::stage_4(&polder_io::generate::segments(60, 10, 3));
    let mesh = Mesh::with_slots(&gpu.device, start.positions.len(), start.mesh.slots()).unwrap();
    let subs = gpu.buffer(&[[0u32, 1]; 10]);
    let vertices = gpu.buffer(&vec![0u32; start.positions.len()]);
    let fewer = vertices.slice(0..start.positions.len() - 1).unwrap();
    let enough = stages[0].buffers(10, 1, start.mesh.slots()).unwrap();
    let few_slots = stages[0].buffers(10, 1, start.mesh.slots() - 1).unwrap();
    let few_subs = stages[0].buffers(9, 1, start.mesh.slots()).unwrap();
    for (buffers, spokes) in [(&few_slots, vertices.view()), (&few_subs, vertices.view()), (&enough, fewer)] {
        let input = Input { sub_constraints: subs.view(), count: None, spokes, degrees: vertices.view(), pieces: None };
        let mut recording = gpu.recording();
        assert!(stages[0].record(&mut recording, &mesh, buffers, input).is_err());
        assert!(recording.is_empty());
    }
    assert!(stages[0].buffers(reference::MOST_SUB_CONSTRAINTS + 1, 1, 10).is_err());
}

/// Quadratic in flips, linear in rounds, and no worse than that: the bound of [QCT] claims 1 and 2.
fn assert_bad_case(gpu: &mut Gpu, stage: &Stage, k: usize) {
    let (start, positions, ends) = bad_case::bad_mesh(k);
    let chain = reference::triangle_chain(&start, &positions, ends).unwrap();
    let length = chain.triangles.len() as u64;
    let case = Case { mesh: &start, positions: &positions, sub_constraints: &[ends] };
    let report = assert_inserted(gpu, stage, "bad case", &case, 0);
    assert!(k < 5 || report.flips[2] >= (k * k) as u64, "{report}");
    assert!(report.all_flips() <= length * length && report.inner_rounds <= 4 * length, "{report}");
}

#[test]
fn the_bad_case_for_some_k() {
    let (mut gpu, stages) = stages();
    for (turn, k) in [1, 2, 5, 25, 100, 200].into_iter().enumerate() {
        assert_bad_case(&mut gpu, &stages[turn % 2], k);
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn the_bad_case_for_large_k() {
    let (mut gpu, stages) = stages();
    for k in [500, 1000] {
        assert_bad_case(&mut gpu, &stages[0], k);
    }
}

/// All constraints of a fan run through the same few triangles, and wait for their turn: together they walk less than if each
/// walked once.
#[test]
fn a_fan() {
    let (mut gpu, stages) = stages();
    let start = Start::stage_4(&polder_io::generate::fan(1200, 5));
    let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
    let case = Case { mesh: &start.mesh, positions: &start.positions, sub_constraints: &walk.sub_constraints };
    let report = assert_inserted(&mut gpu, &stages[0], "fan", &case, LONGEST_REBUILT);
    assert!(report.outer_rounds < 40 && report.inner_rounds > 8 * report.outer_rounds, "{report}");
    assert!(report.walked < walk.intersections(), "{report}, walked {}", report.walked);
}
