//! Loops that the host does not look at until later: the same results as with loops that it waits for, fewer waits.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::kernels::*;
use polder_vulkan::{Buffer, Error, Kernel, Recording, RunOptions, RunReport, groups_for};
use polder_vulkan::{ReadBack, reference};
use rand_core::RngCore;
use std::cell::{Cell, RefCell};
use vulkan_support::{Gpu, random, words};

/// The longest loop.
const LONGEST: usize = 12;
const WORDS: usize = 64;

struct World {
    gpu: Gpu,
    scan: Kernel<ScanSums>,
    size: Kernel<DispatchSize>,
    copy: Kernel<CopyWords>,
    /// For each loop a row of ones, as many as it has rounds; and a second row for moving it.
    rows: Vec<[Buffer<u32>; 2]>,
    state: Buffer<u32>,
    other: Buffer<u32>,
    groups: Buffer<u32>,
}

#[derive(Debug, Clone, Copy)]
enum Op {
    /// Not the same when done twice.
    Scan,
    Fill(usize, u32),
    Copy(usize),
    /// Bytes that no kernel copies.
    OddCopy(usize),
    /// As many words, in steps of 1024, as a counter says.
    Indirect,
    Read,
    Loop {
        row: usize,
        first: u32,
        batch: u32,
        ahead: bool,
        inner: bool,
    },
}

const ROWS: usize = 5;
const NAMES: [&str; ROWS] = ["first", "second", "third", "fourth", "fifth"];

impl World {
    fn new() -> World {
        let mut gpu = Gpu::open();
        let mut row = || gpu.buffer(&[0_u32; 4 * (LONGEST + 2)]);
        World {
            rows: (0..ROWS).map(|_| [row(), row()]).collect(),
            scan: Kernel::new(&gpu.device, &[]).unwrap(),
            size: Kernel::new(&gpu.device, &[]).unwrap(),
            copy: Kernel::new(&gpu.device, &[]).unwrap(),
            state: gpu.buffer(&[0_u32; WORDS]),
            other: gpu.buffer(&[0_u32; WORDS]),
            groups: gpu.buffer(&[0_u32; 3]),
            gpu,
        }
    }

    fn reset(&mut self, rounds: [usize; ROWS]) {
        for ([row, spare], rounds) in self.rows.iter().zip(rounds) {
            let mut ones = vec![0_u32; row.len()];
            ones[..4 * rounds].fill(1);
            self.gpu.engine.upload(row.view(), &ones).unwrap();
            self.gpu.engine.upload(spare.view(), &vec![0; row.len()]).unwrap();
        }
        self.gpu.engine.upload(self.state.view(), &words(3, WORDS)).unwrap();
        self.gpu.engine.upload(self.other.view(), &words(4, WORDS)).unwrap();
        self.gpu.engine.upload(self.groups.view(), &[1, 1, 1]).unwrap();
    }

    fn record(&self, recording: &mut Recording, ops: &[Op], reads: &mut Vec<ReadBack>) {
        let (state, other) = (self.state.view(), self.other.view());
        for op in ops {
            match *op {
                Op::Scan => {
                    let arguments =
                        ScanSumsArgs { sums: state, total: None, counter: None, limit: WORDS as u32, tile: 1 };
                    recording.dispatch(&self.scan, [1, 1, 1], &arguments);
                }
                Op::Fill(at, value) => recording.fill(other.slice(4 * at..WORDS).unwrap(), value),
                Op::Copy(at) => recording.copy(state.slice(4 * at..WORDS).unwrap(), other),
                Op::OddCopy(at) => {
                    let bytes = state.cast::<u8>().slice(16 * at..16 * at + 7).unwrap();
                    recording.copy(bytes, other.cast::<u8>());
                }
                Op::Indirect => {
                    let groups = self.groups.view();
                    let arguments = DispatchSizeArgs { counter: Some(other), groups, limit: 2, items: 1 };
                    recording.dispatch(&self.size, [1, 1, 1], &arguments);
                    let arguments = CopyWordsArgs { from: state, to: other, count: WORDS as u32 };
                    recording.dispatch_indirect(&self.copy, groups, &arguments);
                }
                Op::Read => reads.push(recording.read(state)),
                Op::Loop { row, first, batch, ahead, inner } => {
                    let name = NAMES[row];
                    let [row, spare] = &self.rows[row];
                    let end = row.len();
                    let body = |body: &mut Recording| {
                        body.copy(row.view(), spare.view());
                        // In vain, unless the loop halted with the sizes zero.
                        let arguments = CopyWordsArgs { from: spare.view(), to: row.view(), count: 4 };
                        body.dispatch_indirect(&self.copy, self.groups.view(), &arguments);
                        body.copy(spare.slice(4..end).unwrap(), row.view());
                        if inner {
                            body.repeat_ahead("inner", row.slice(end - 4..end).unwrap(), 1, 1, 1, |_| {});
                        }
                    };
                    if ahead {
                        recording.repeat_ahead(name, row.view(), 50, first, batch, body);
                    } else {
                        recording.repeat(name, row.view(), 50, batch, body);
                    }
                }
            }
        }
    }

    /// What is in memory, what was read, and the report.
    fn run(&mut self, ops: &[Op], rounds: [usize; ROWS], timestamps: bool) -> (Vec<Vec<u32>>, RunReport) {
        self.reset(rounds);
        let (mut recording, mut reads) = (self.gpu.recording(), Vec::new());
        self.record(&mut recording, ops, &mut reads);
        let report = self.gpu.engine.run(&recording, &RunOptions { timestamps, ..RunOptions::default() }).unwrap();
        let mut found: Vec<Vec<u32>> = reads.iter().map(|&read| report.words(read).to_vec()).collect();
        let rows = self.rows.iter().map(|[row, _]| row);
        for buffer in rows.chain([&self.state, &self.other]) {
            found.push(self.gpu.engine.download_vec(buffer.view()).unwrap());
        }
        (found, report)
    }
}

/// All loops as plain ones.
fn plain(ops: &[Op]) -> Vec<Op> {
    let plain = |op: &Op| match *op {
        Op::Loop { row, batch, inner, .. } => Op::Loop { row, first: batch, batch, ahead: false, inner },
        op => op,
    };
    ops.iter().map(plain).collect()
}

#[test]
fn whatever_was_guessed_the_results_are_those_of_plain_loops() {
    let mut world = World::new();
    let (mut waits, mut plain_waits, mut good) = (0, 0, 0);
    for seed in 0..120 {
        let mut random = random(seed);
        let mut below = |n: u32| random.next_u32() % n;
        let guess_well = seed % 3 == 0;
        let rounds = [0; ROWS].map(|_| below(LONGEST as u32 + 1) as usize);
        let mut ops = Vec::new();
        let mut row = 0;
        while row < ROWS {
            ops.push(match below(12) {
                0..=2 => Op::Scan,
                3 => Op::Fill(below(16) as usize, below(3)),
                4 => Op::Copy(below(16) as usize),
                5 if !guess_well => Op::OddCopy(below(15) as usize),
                6 => Op::Indirect,
                7 => Op::Read,
                _ => {
                    row += 1;
                    let first = if guess_well { rounds[row - 1] as u32 } else { below(9) };
                    let ahead = guess_well || below(5) > 0;
                    Op::Loop { row: row - 1, first, batch: 1 + below(4), ahead, inner: !guess_well && below(8) == 0 }
                }
            });
        }
        ops.extend([Op::Scan, Op::Indirect, Op::Read]);
        let (found, report) = world.run(&ops, rounds, seed % 2 == 0);
        let (expected, plain_report) = world.run(&plain(&ops), rounds, false);
        assert_eq!(found, expected, "{seed}: {rounds:?} {ops:?}");
        for report in [&report, &plain_report] {
            let ended = report.rounds.iter().map(|(name, _)| *name).filter(|name| *name != "inner");
            assert_eq!(ended.collect::<Vec<_>>(), NAMES, "{seed}");
        }
        if guess_well {
            assert_eq!((report.waits, report.submissions), (1, 1), "{seed}: {rounds:?} {ops:?}");
            good += 1;
        }
        waits += report.waits;
        plain_waits += plain_report.waits;
    }
    assert!(good == 40 && waits < plain_waits, "{waits} {plain_waits}");
}

#[test]
fn a_wait_for_each_bad_guess_and_one_for_all_good_ones() {
    let mut world = World::new();
    let ahead = |row, first| Op::Loop { row, first, batch: 4, ahead: true, inner: false };
    let rounds = [3, 9, 2, 5, 0];
    let ops = |firsts: [u32; ROWS]| {
        let loops = firsts.iter().enumerate().flat_map(|(row, &first)| [Op::Scan, ahead(row, first)]);
        loops.chain([Op::Scan]).collect::<Vec<_>>()
    };
    for (firsts, waits, counted) in [
        ([3, 9, 2, 5, 1], 1, [3, 9, 2, 5, 1]),
        // The second loop goes on by 4 and by 8, and those behind it begin with 4 rounds more.
        ([3, 2, 2, 1, 1], 3, [3, 14, 6, 5, 5]),
        ([1, 9, 2, 5, 1], 2, [5, 13, 6, 9, 5]),
        // A loop without first rounds gets none on account of others.
        ([1, 9, 2, 5, 0], 2, [5, 13, 6, 9, 0]),
        ([3, 9, 0, 5, 0], 2, [3, 9, 4, 9, 0]),
    ] {
        let (_, report) = world.run(&ops(firsts), rounds, true);
        assert_eq!(report.rounds.iter().map(|(_, rounds)| *rounds).collect::<Vec<_>>(), counted);
        assert_eq!(report.waits, waits, "{firsts:?}");
    }
}

#[test]
fn bounds_cancelling_and_progress() {
    let mut world = World::new();
    let [row, _] = [0, 1];
    let told = RefCell::new(Vec::new());
    let progress = |name, rounds| told.borrow_mut().push((name, rounds));
    let record = |world: &World, recording: &mut Recording, bound: u32, first: u32| {
        let [row, spare] = &world.rows[row];
        recording.repeat_ahead("short", row.view(), bound, first, 2, |body| {
            body.copy(row.view(), spare.view());
            body.copy(spare.slice(4..row.len()).unwrap(), row.view());
        });
        recording.fill(world.state.view(), 7);
    };
    for (bound, first, looks) in
        [(5, 1, vec![1, 3, 5]), (5, 9, vec![5]), (0, 1, vec![0]), (9, 4, vec![4, 6, 9]), (9, 8, vec![8])]
    {
        world.reset([8, 0, 0, 0, 0]);
        told.borrow_mut().clear();
        let mut recording = world.gpu.recording();
        record(&world, &mut recording, bound, first);
        let options = RunOptions { progress: Some(&progress), ..RunOptions::default() };
        let done = world.gpu.engine.run(&recording, &options);
        assert_eq!(told.borrow().iter().map(|(_, rounds)| *rounds).collect::<Vec<_>>(), looks);
        let state = world.gpu.fetch(world.state.view());
        if bound < 8 {
            assert_eq!(done.unwrap_err(), Error::Bound { name: "short", bound });
            assert_eq!(state, words(3, WORDS), "what follows a loop that failed has not run");
        } else {
            assert_eq!(done.unwrap().rounds, [("short", *looks.last().unwrap())]);
            assert_eq!(state, [7; WORDS]);
        }
    }
    world.reset([8, 0, 0, 0, 0]);
    let mut recording = world.gpu.recording();
    record(&world, &mut recording, 50, 2);
    let asked = Cell::new(0);
    let cancel = || {
        asked.set(asked.get() + 1);
        asked.get() == 2
    };
    let options = RunOptions { cancel: Some(&cancel), ..RunOptions::default() };
    assert_eq!(world.gpu.engine.run(&recording, &options).unwrap_err(), Error::Cancelled);
    let [row, _] = &world.rows[row];
    assert_eq!(world.gpu.engine.download_vec(row.view()).unwrap().iter().sum::<u32>(), 4 * (8 - 4));
}

#[test]
fn more_commands_than_one_submission_can_time_and_a_long_table() {
    let mut world = World::new();
    world.reset([3, 5, 0, 0, 0]);
    let fill = Op::Fill(0, 1);
    let ahead = |row, first| Op::Loop { row, first, batch: 2, ahead: true, inner: false };
    let mut ops = vec![ahead(0, 3)];
    ops.extend([Op::Scan, fill].repeat(1500));
    ops.extend([ahead(1, 2), Op::Scan]);
    ops.extend([fill, Op::Scan].repeat(1500));
    let (found, report) = world.run(&ops, [3, 5, 0, 0, 0], true);
    let (expected, _) = world.run(&plain(&ops), [3, 5, 0, 0, 0], false);
    assert!(found == expected);
    assert_eq!(report.rounds, [("first", 3), ("second", 8)]);
}

/// Loss, time-out and refused memory at every place: the typed error, everything given back, and the next call works.
#[test]
fn failures_at_every_place_give_everything_back() {
    let ahead = |row, first| Op::Loop { row, first, batch: 2, ahead: true, inner: false };
    let ops = [ahead(0, 2), Op::Scan, ahead(1, 2), Op::Scan, ahead(2, 5), Op::Fill(0, 9), Op::Read];
    let rounds = [2, 6, 5, 0, 0];
    let (expected, report) = World::new().run(&ops, rounds, false);
    assert_eq!(report.submissions, 3);
    for (kind, places) in [(0, 3), (1, 3), (2, 2)] {
        for index in 0..=places {
            let mut world = World::new();
            let (device, mut recording) = (world.gpu.device.clone(), world.gpu.recording());
            world.reset(rounds);
            world.record(&mut recording, &ops, &mut Vec::new());
            match kind {
                0 => device.faults().lose_at_submission(index),
                1 => device.faults().time_out_at_submission(index),
                _ => device.faults().refuse_allocation(index),
            }
            let done = world.gpu.engine.run(&recording, &RunOptions::default());
            device.faults().clear();
            match (done, kind) {
                (Ok(_), _) => assert_eq!(index, places, "{kind}"),
                (Err(Error::DeviceLost), 0) => assert!(index < places && device.is_lost()),
                (Err(Error::Timeout { .. }), 1) | (Err(Error::OutOfMemory { .. }), 2) => assert!(index < places),
                (Err(other), _) => panic!("{other}"),
            }
            if !device.is_lost() {
                assert_eq!(world.run(&ops, rounds, false).0, expected, "{kind} {index}");
            }
            drop((recording, world));
            assert_eq!(device.memory_use().used, 0, "{kind} {index}");
        }
    }
}

#[test]
fn fill_words() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<FillWords>::new(&gpu.device, &[]).unwrap();
    for len in [0, 1, 2, 3, 4, 5, 255, 4095, 4096, 4097, 123_457] {
        let buffer = gpu.buffer(&vec![7_u32; len + 9]);
        let mut recording = gpu.recording();
        let arguments = FillWordsArgs { to: buffer.view(), value: 0xabcd_ef01, count: len as u32 };
        recording.dispatch(&kernel, groups_for(len, 4096), &arguments);
        gpu.run(&recording);
        let mut expected = vec![7; len + 9];
        reference::fill_words(&mut expected[..len], 0xabcd_ef01);
        assert!(gpu.fetch(buffer.view()) == expected, "{len}");
    }
}

#[test]
fn halt_unfinished() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<HaltUnfinished>::new(&gpu.device, &[]).unwrap();
    for (counter, before) in [(0, 0), (5, 0), (0, 2), (5, 2)] {
        for (size_count, address_count) in [(0, 0), (1, 1), (64, 3), (300, 260)] {
            let threes: Vec<[u32; 3]> = words(1, 3 * address_count).chunks(3).map(|w| [w[0], w[1], w[2]]).collect();
            let elsewhere: Vec<Buffer<u32>> = threes.iter().map(|three| gpu.buffer(three)).collect();
            let addresses: Vec<u64> = elsewhere.iter().map(|buffer| buffer.view().device_address()).collect();
            let table = words(2, 4 * size_count);
            let (word, halt) = (gpu.buffer(&[counter]), gpu.buffer(&[before]));
            let (sizes, list) = (gpu.buffer(&table), gpu.buffer(&addresses));
            let saved = gpu.buffer(&vec![7_u32; 4 * address_count]);
            let arguments = HaltUnfinishedArgs {
                counter: word.view(),
                halt: halt.view(),
                sizes: sizes.view(),
                addresses: list.view(),
                saved: saved.view(),
                number: 3,
                size_count: size_count as u32,
                address_count: address_count as u32,
            };
            let mut recording = gpu.recording();
            recording.dispatch(&kernel, [1, 1, 1], &arguments);
            gpu.run(&recording);
            let mut expected: Vec<[u32; 4]> = table.chunks(4).map(|w| [w[0], w[1], w[2], w[3]]).collect();
            let (mut halted, mut groups, mut kept) = (before, threes.clone(), vec![[7; 3]; address_count]);
            reference::halt_unfinished(counter, 3, &mut halted, &mut expected, &mut groups, &mut kept);
            assert_eq!(gpu.fetch(halt.view()), [halted]);
            assert_eq!(gpu.fetch(sizes.view()), expected.concat());
            let found: Vec<Vec<u32>> = elsewhere.iter().map(|buffer| gpu.fetch(buffer.view())).collect();
            assert_eq!(found, groups);
            let found = gpu.fetch(saved.view());
            assert!(found.chunks(4).zip(&kept).all(|(found, kept)| found[..3] == *kept && found[3] == 7));
        }
    }
}
