//! The kernels with which walks through many vertices begin again against the references of their names.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::{Start, grid};
use polder_constrain::gpu::pieces::Grid;
use polder_constrain::kernels::*;
use polder_constrain::reference::kernels as expected;
use polder_flip::gpu::Arithmetic;
use polder_io::generate;
use polder_mesh::NONE;
use polder_vulkan::{Kernel, Shader};
use vulkan_support::Gpu;

/// Places of words, as in `walk.glsl`.
const WORDS: usize = 128;
const WAITING: usize = 0;
const GROUPS: usize = 4;
const STOPS: usize = 8;
const CHOSEN: usize = 25;
const CHOSEN_LIST: usize = 28;
const CHOSEN_FOUND: usize = 60;
const CHOSEN_NEED: usize = 92;
const CHOSEN_RUN: usize = 124;
const BUCKETS: usize = 125;
const STOPS_BEFORE: usize = 126;
const REVERSED: u32 = 1 << 31;
const AGAIN: u32 = 1 << 30;

fn run<S: Shader>(gpu: &mut Gpu, kernel: &Kernel<S>, groups: u32, arguments: &S::Args<'_>) {
    let mut recording = gpu.recording();
    recording.dispatch(kernel, [groups, 1, 1], arguments);
    gpu.run(&recording);
}

#[test]
fn plan_again() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<PlanAgain>::new(&gpu.device, &[]).unwrap();
    let constraints = 5000usize;
    for (turn, (waiting, of, room)) in
        [(0, 1, 9000), (1, 1, 9000), (700, 9, 9000), (900, 40, 9000), (4096, 32, 9000), (5000, 3, 9000), (60, 9, 900)]
            .into_iter()
            .enumerate()
    {
        // The first pieces of some, and the later ones of others, two of each.
        let later = 40;
        let words = vulkan_support::words(turn as u64, waiting);
        let one = |i: u32| if i < of / 2 { i * 71 } else { constraints as u32 + 2 * (i - of / 2) + i % 2 };
        let list: Vec<u32> = words.iter().map(|word| one(word % of)).collect();
        let owner = |item: u32| if item < 5000 { item } else { (item - 5000) / 2 * 71 + 3 };
        let pieces: Vec<[u32; 4]> =
            (0..room as u32).map(|p| [p / 2 * 71 + 3, (p % 2 + 1) << 16 | 3, NONE, NONE]).collect();
        let runs: Vec<u32> = (0..5000u32).map(|c| if c % 71 == 3 { c / 71 * 2 } else { NONE }).collect();
        let items = constraints + room;
        let mut state = vec![7; 3 * items];
        state[2 * items..2 * items + waiting].copy_from_slice(&list);
        let mut words = vec![0; WORDS];
        (words[WAITING], words[2], words[STOPS]) = (waiting as u32, 1, 123);
        let (state, runs, pieces) = (gpu.buffer(&state), gpu.buffer(&runs), gpu.buffer(&pieces));
        let (piece_met, piece_count, words) = (gpu.buffer(&vec![7u32; room]), gpu.buffer(&[later]), gpu.buffer(&words));
        let arguments = PlanAgainArgs {
            state: state.view(),
            runs: runs.view(),
            pieces: pieces.view(),
            piece_met: piece_met.view(),
            piece_count: piece_count.view(),
            words: words.view(),
            constraints: constraints as u32,
            piece_limit: room as u32,
        };
        run(&mut gpu, &kernel, 1, &arguments);
        let owners: Vec<u32> = list.iter().map(|&item| owner(item)).collect();
        let (wanted, buckets) = match waiting {
            1..=4096 => expected::plan_again(&owners, room - later as usize),
            _ => (Vec::new(), 0),
        };
        let words = gpu.fetch(words.view());
        let count = wanted.len().min(32);
        assert_eq!([words[CHOSEN], words[BUCKETS]], [count as u32, buckets]);
        let mut found = words[CHOSEN_LIST..CHOSEN_LIST + count].to_vec();
        let later_of = |c: u32| if c % 71 == 3 { 3 } else { 1 };
        assert!((0..count).all(|slot| words[CHOSEN_NEED + slot] == 64 + 2 * later_of(found[slot])));
        let pieces = gpu.fetch(pieces.view());
        for (k, &piece) in pieces[later as usize..].iter().take(count * buckets as usize).enumerate() {
            let (slot, number) = (k / buckets as usize, k as u32 % buckets + 1);
            assert_eq!(piece, [found[slot], number << 16 | (buckets + 1), NONE, 0]);
        }
        found.sort_unstable();
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]) && found.iter().all(|c| wanted.contains(c)));
        let more = count as u32 * (buckets + 1);
        assert_eq!(words[WAITING], waiting as u32 + more);
        if count > 0 {
            let [run, stops] = [CHOSEN_RUN, STOPS_BEFORE].map(|word| words[word]);
            assert_eq!([run, stops, words[GROUPS]], [later, 123, (waiting as u32 + more).div_ceil(256)]);
            let state = gpu.fetch(state.view());
            assert!(
                state[2 * items..][..waiting] == list
                    && state[2 * items + waiting..][..more as usize].iter().all(|&i| i == NONE)
            );
        }
        assert_eq!(gpu.fetch(piece_count.view())[0], later + count as u32 * buckets);
    }
}

/// A line through many vertices, and others.
struct Case {
    start: Start,
    grid: Grid,
    spokes: Vec<u32>,
    ends: Vec<[u32; 2]>,
}

fn case(count: usize, seed: u64) -> Case {
    let start = Start::stage_4(&generate::through_vertices(count, seed));
    let grid = grid(&start.positions);
    let (spokes, _) = expected::find_spokes(&start.mesh, start.positions.len());
    let [a, b] = start.constraints[0];
    let ends = vec![[a, b], [3, 7], [b, a], [a, 5]];
    Case { start, grid, spokes, ends }
}

#[test]
fn spread_vertices() {
    let mut gpu = Gpu::open();
    let kernels = [Arithmetic::Filtered, Arithmetic::Integers]
        .map(|arithmetic| arithmetic.kernel::<SpreadVertices>(&gpu.device, &[]).unwrap());
    for (turn, (count, buckets)) in [(10, 128), (700, 128), (900, 1000), (3000, 500)].into_iter().enumerate() {
        let case = case(count, turn as u64);
        let mesh = polder_flip::gpu::Mesh::new(&gpu.device, case.start.positions.len()).unwrap();
        mesh.upload(&mut gpu.engine, &case.start.mesh, &case.start.positions).unwrap();
        let chosen = [0u32, 1, 3, 2];
        let directions = [0u32, REVERSED, 0, REVERSED];
        let mut words = vec![0; WORDS];
        (words[CHOSEN], words[CHOSEN_RUN], words[BUCKETS]) = (4, 5, buckets);
        words[CHOSEN_LIST..CHOSEN_LIST + 4].copy_from_slice(&chosen);
        let pieces = vec![[1, 2, NONE, 0]; 5 + 4 * buckets as usize];
        let (ends, spokes, met) = (gpu.buffer(&case.ends), gpu.buffer(&case.spokes), gpu.buffer(&directions));
        let (pieces, words) = (gpu.buffer(&pieces), gpu.buffer(&words));
        let (exponent, [low_x, low_y]) = case.grid.fine();
        let arguments = SpreadVerticesArgs {
            positions: mesh.positions().cast(),
            ends: ends.view().cast(),
            spokes: spokes.view(),
            met: met.view(),
            pieces: pieces.view(),
            words: words.view(),
            low_x,
            low_y,
            exponent,
            vertices: case.start.positions.len() as u32,
        };
        run(&mut gpu, &kernels[turn % 2], 3, &arguments);
        let (pieces, words) = (gpu.fetch(pieces.view()), gpu.fetch(words.view()));
        for (slot, &c) in chosen.iter().enumerate() {
            let [a, b] = case.ends[c as usize];
            let line = if directions[c as usize] != 0 { [b, a] } else { [a, b] };
            let wanted = expected::spread_vertices(&case.start.positions, &case.spokes, line, &case.grid, buckets);
            let found = &pieces[5 + slot * buckets as usize..][..buckets as usize];
            let word = |&v: &u32| if v == NONE { NONE } else { 1 << 31 | v };
            assert!(found.iter().map(|piece| piece[2]).eq(wanted.iter().map(word)), "{count}: {slot}");
            let some = wanted.iter().filter(|&&v| v != NONE).count();
            assert_eq!(words[CHOSEN_FOUND + slot] as usize, some);
            assert!(c % 2 == 1 || some >= count.min(buckets as usize) / 3, "{some} of {count}");
        }
    }
}

#[test]
fn begin_again() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<BeginAgain>::new(&gpu.device, &[]).unwrap();
    let case = case(900, 5);
    let (buckets, run_at, constraints, room) = (600u32, 6u32, case.ends.len(), 2000usize);
    let chosen = [2u32, 1];
    let directions = [0u32, REVERSED | 9, REVERSED | 4, 0];
    // The third has two later pieces and begins again, the second has none and does not.
    let runs = [NONE, NONE, 2, NONE];
    let mut pieces = vec![[0, 1 << 16 | 2, NONE, NONE]; room];
    for number in 1..3u32 {
        pieces[1 + number as usize] = [2, number << 16 | 3, 8, NONE];
    }
    let mut words = vec![0; WORDS];
    let mut wanted = Vec::new();
    for (slot, &c) in chosen.iter().enumerate() {
        let [a, b] = case.ends[c as usize];
        let least = expected::spread_vertices(&case.start.positions, &case.spokes, [b, a], &case.grid, buckets);
        for (k, &v) in least.iter().enumerate() {
            let word = if v == NONE { NONE } else { 1 << 31 | v };
            pieces[run_at as usize + slot * buckets as usize + k] = [c, (k as u32 + 1) << 16 | (buckets + 1), word, 0];
        }
        let pieces_of = if c == 2 { 3 } else { 1 };
        words[CHOSEN_LIST + slot] = c;
        words[CHOSEN_FOUND + slot] = least.iter().filter(|&&v| v != NONE).count() as u32;
        words[CHOSEN_NEED + slot] = 64 + 2 * pieces_of;
        wanted.push(expected::begin_again(&least, pieces_of));
    }
    let begun = wanted[0].clone().unwrap();
    assert!(wanted[1].is_none() && begun.len() > 100);
    let before = [0u32, 2, constraints as u32 + 2, 1, constraints as u32 + 3, constraints as u32];
    let items = constraints + room;
    let mut state = vec![7; 3 * items];
    let more = 2 * (buckets as usize + 1);
    state[items..items + before.len()].copy_from_slice(&before);
    state[items + before.len()..][..more].fill(NONE);
    words[WAITING] = (before.len() + more) as u32;
    (words[CHOSEN], words[CHOSEN_RUN], words[BUCKETS], words[STOPS]) = (2, run_at, buckets, 11);
    let stop_room = 11 + begun.len();
    let (ends, spokes, met) = (gpu.buffer(&case.ends), gpu.buffer(&case.spokes), gpu.buffer(&directions));
    let (runs, on_pieces, piece_met) = (gpu.buffer(&runs), gpu.buffer(&pieces), gpu.buffer(&vec![0u32; room]));
    let (stops, state, words) = (gpu.buffer(&vec![[7u32; 3]; stop_room]), gpu.buffer(&state), gpu.buffer(&words));
    let arguments = BeginAgainArgs {
        ends: ends.view().cast(),
        spokes: spokes.view(),
        met: met.view(),
        runs: runs.view(),
        pieces: on_pieces.view(),
        piece_met: piece_met.view(),
        stops: stops.view().cast(),
        state: state.view(),
        words: words.view(),
        constraints: constraints as u32,
        piece_limit: room as u32,
        stop_limit: stop_room as u32,
    };
    run(&mut gpu, &kernel, 2, &arguments);
    assert_eq!(gpu.fetch(runs.view()), [NONE, NONE, run_at, NONE]);
    assert_eq!(gpu.fetch(met.view()), [0, REVERSED | 9, REVERSED | AGAIN, 0]);
    (pieces[2][3], pieces[run_at as usize][3]) = (0, NONE);
    assert!(gpu.fetch(on_pieces.view()) == pieces);
    let item = |number: u32| constraints as u32 + run_at + number - 1;
    let list = gpu.fetch(state.view())[items..][..before.len() + more].to_vec();
    let mut found: Vec<u32> = list.into_iter().filter(|&item| item != NONE).collect();
    let mut kept: Vec<u32> = [0, 1, constraints as u32, 2].into_iter().chain(begun.iter().map(|b| item(b.0))).collect();
    found.sort_unstable();
    kept.sort_unstable();
    assert_eq!(found, kept);
    let (state, piece_met) = (gpu.fetch(state.view()), gpu.fetch(piece_met.view()));
    assert_eq!(state[2], case.spokes[case.ends[2][1] as usize]);
    for &(number, v) in &begun {
        assert_eq!(state[item(number) as usize], case.spokes[v as usize]);
    }
    let begins = |p: usize| begun.iter().any(|b| item(b.0) as usize == constraints + p);
    assert!(piece_met.iter().enumerate().all(|(p, &met)| met == u32::from(begins(p))));
    let mut stops = gpu.fetch(stops.view())[11..].to_vec();
    stops.sort_unstable();
    assert!(stops.into_iter().eq(begun.iter().map(|&(number, v)| [item(number), 0, v])));
    assert_eq!(gpu.fetch(words.view())[STOPS] as usize, stop_room);
}
