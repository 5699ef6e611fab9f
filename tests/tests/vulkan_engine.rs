//! The engine: order of commands, repeated bodies, transfers, time, and what is refused.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::kernels::{CopyWords, CopyWordsArgs, DispatchSize, DispatchSizeArgs, ScanSums, ScanSumsArgs};
use polder_vulkan::primitives::{Scan, Sort};
use polder_vulkan::{Buffer, Downloads, Error, Kernel, Recording, RunOptions, Timings, groups_for, reference};
use std::cell::{Cell, RefCell};
use vulkan_support::{Gpu, words};

/// Halves the word at `counter` each round: a loop of as many rounds as the word has bits.
fn halving(recording: &mut Recording, gpu: &Gpu, counter: &Buffer<u32>, groups: &Buffer<u32>, bound: u32, batch: u32) {
    let kernel = Kernel::<DispatchSize>::new(&gpu.device, &[]).unwrap();
    recording.repeat("halving", counter.view(), bound, batch, |body| {
        // Workgroups of two for n items, less one: half of n, rounded down.
        let arguments =
            DispatchSizeArgs { counter: Some(counter.view()), groups: groups.view(), limit: u32::MAX, items: 2 };
        body.dispatch(&kernel, [1, 1, 1], &arguments);
        body.copy(groups.slice(0..1).unwrap(), counter.view());
    });
}

#[test]
fn a_repeated_body_ends_when_its_counter_is_zero() {
    let mut gpu = Gpu::open();
    // n -> ceil(n / 2) stays at 1: counts down to it and no further, so the bound strikes.
    for (batch, waits) in [(1, 6), (4, 2), (100, 1)] {
        let (counter, groups) = (gpu.buffer(&[32_u32]), gpu.buffer(&[0_u32; 3]));
        let mut recording = gpu.recording();
        halving(&mut recording, &gpu, &counter, &groups, 6, batch);
        let told = RefCell::new(Vec::new());
        let progress = |name, rounds| told.borrow_mut().push((name, rounds));
        let options = RunOptions { progress: Some(&progress), ..RunOptions::default() };
        assert_eq!(gpu.engine.run(&recording, &options).unwrap_err(), Error::Bound { name: "halving", bound: 6 });
        assert_eq!(told.borrow().len(), waits);
        assert_eq!(told.borrow().last(), Some(&("halving", 6)));
        assert_eq!(gpu.fetch(counter.view()), [1]);
    }
    // From zero on nothing is left to do after the first batch.
    let (counter, groups) = (gpu.buffer(&[0_u32]), gpu.buffer(&[0_u32; 3]));
    let mut recording = gpu.recording();
    halving(&mut recording, &gpu, &counter, &groups, 6, 2);
    let report = gpu.run(&recording);
    assert_eq!((report.rounds, report.submissions, report.waits), (vec![("halving", 2)], 1, 1));
}

#[test]
fn rounds_are_counted_by_batches() {
    let mut gpu = Gpu::open();
    let row = gpu.buffer(&[1_u32; 8 * 4]);
    let next = gpu.buffer(&[0_u32; 9 * 4]);
    // Each round moves the row on by four words, zeros behind it.
    for (batch, expected) in [(1_u32, 8_u32), (3, 9), (100, 20)] {
        gpu.engine.upload(row.view(), &[1_u32; 8 * 4]).unwrap();
        let mut recording = gpu.recording();
        recording.repeat("moving", row.view(), 20, batch, |body| {
            body.copy(row.view(), next.view());
            body.copy(next.slice(4..36).unwrap(), row.view());
        });
        let report = gpu.run(&recording);
        assert_eq!((report.rounds, report.waits), (vec![("moving", expected)], expected.div_ceil(batch)));
    }
}

#[test]
fn a_repeated_body_can_be_cancelled() {
    let mut gpu = Gpu::open();
    let (counter, groups) = (gpu.buffer(&[32_u32]), gpu.buffer(&[0_u32; 3]));
    let mut recording = gpu.recording();
    halving(&mut recording, &gpu, &counter, &groups, 1000, 1);
    let asked = Cell::new(0);
    let cancel = || {
        asked.set(asked.get() + 1);
        asked.get() == 3
    };
    let options = RunOptions { cancel: Some(&cancel), ..RunOptions::default() };
    assert_eq!(gpu.engine.run(&recording, &options).unwrap_err(), Error::Cancelled);
    assert_eq!(gpu.fetch(counter.view()), [4]);
}

#[test]
fn repeated_bodies_nest() {
    let mut gpu = Gpu::open();
    let (outer, inner) = (gpu.buffer(&[0_u32]), gpu.buffer(&[0_u32]));
    let groups = gpu.buffer(&[0_u32; 3]);
    let mut recording = gpu.recording();
    let mut read = None;
    recording.repeat("outer", outer.view(), 3, 1, |body| {
        body.fill(inner.view(), 0);
        halving(body, &gpu, &inner, &groups, 5, 2);
        read = Some(body.read(groups.view()));
    });
    let after = recording.read(inner.view());
    let report = gpu.run(&recording);
    assert_eq!(report.rounds, [("halving", 2), ("outer", 1)]);
    assert_eq!((report.words(read.unwrap()), report.word(after)), ([0; 3].as_slice(), 0));
}

#[test]
fn indirect_dispatches_run_what_the_device_says() {
    let mut gpu = Gpu::open();
    let size = Kernel::<DispatchSize>::new(&gpu.device, &[]).unwrap();
    let copy = Kernel::<CopyWords>::new(&gpu.device, &[]).unwrap();
    let source = words(1, 100_000);
    let from = gpu.buffer(&source);
    for count in [0_u32, 1, 4096, 4097, 100_000] {
        let (counter, groups) = (gpu.buffer(&[count]), gpu.buffer(&[7_u32; 3]));
        let to = gpu.buffer(&vec![7_u32; source.len()]);
        let mut recording = gpu.recording();
        let arguments =
            DispatchSizeArgs { counter: Some(counter.view()), groups: groups.view(), limit: u32::MAX, items: 4096 };
        recording.dispatch(&size, [1, 1, 1], &arguments);
        let arguments = CopyWordsArgs { from: from.view(), to: to.view(), count: source.len() as u32 };
        recording.dispatch_indirect(&copy, groups.view(), &arguments);
        let report = gpu.run(&recording);
        assert_eq!(report.barriers, 1);
        let end = source.len().min(count.div_ceil(4096) as usize * 4096);
        let found = gpu.fetch(to.view());
        assert!(found[..end] == source[..end] && found[end..].iter().all(|word| *word == 7), "{count}");
    }
}

#[test]
fn commands_that_do_not_conflict_need_no_barrier() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<CopyWords>::new(&gpu.device, &[]).unwrap();
    let (a, b, c) = (gpu.buffer(&[1_u32; 8]), gpu.buffer(&[2_u32; 8]), gpu.buffer(&[3_u32; 8]));
    let mut recording = gpu.recording();
    for (from, to) in [(&a, &b), (&a, &c), (&c, &a), (&c, &b)] {
        recording.dispatch(&kernel, [1, 1, 1], &CopyWordsArgs { from: from.view(), to: to.view(), count: 8 });
    }
    let report = gpu.run(&recording);
    // c was written before it is read; the same barrier orders both later copies.
    assert_eq!((report.dispatches, report.barriers, report.submissions), (4, 1, 1));
    assert_eq!((gpu.fetch(a.view()), gpu.fetch(b.view())), (vec![1; 8], vec![1; 8]));
}

#[test]
fn a_long_chain_keeps_its_order() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<ScanSums>::new(&gpu.device, &[]).unwrap();
    let mut expected = vec![1_u32; 5000];
    let sums = gpu.buffer(&expected);
    let mut recording = gpu.recording();
    for _ in 0..50 {
        let arguments = ScanSumsArgs { sums: sums.view(), total: None, counter: None, limit: 5000, tile: 1 };
        recording.dispatch(&kernel, [1, 1, 1], &arguments);
        expected = reference::scan_sums(&expected).0;
    }
    // Recordings can be run again.
    for _ in 0..2 {
        gpu.engine.upload(sums.view(), &[1_u32; 5000]).unwrap();
        assert_eq!(gpu.run(&recording).barriers, 49);
        assert!(gpu.fetch(sums.view()) == expected);
    }
}

#[test]
fn transfers_of_more_than_staging_holds() {
    let mut gpu = Gpu::open();
    // More chunks than fly at once, and odd bytes.
    let data: Vec<u8> = (0..(80 << 20) + 3).map(|index: u32| (index ^ (index >> 13)) as u8).collect();
    let buffer = gpu.buffer(&data);
    assert!(gpu.fetch(buffer.view()) == data);
    let part = buffer.slice(1 << 20..data.len()).unwrap();
    assert!(gpu.fetch(part) == data[1 << 20..]);
    gpu.engine.upload(part, &data[..100]).unwrap();
    assert!(gpu.fetch(part)[..101] == [&data[..100], &data[(1 << 20) + 100..=(1 << 20) + 100]].concat());
    assert_eq!(gpu.fetch(buffer.slice(0..0).unwrap()), Vec::<u8>::new());
}

#[test]
fn several_downloads_go_as_one_into_memory_that_is_kept() {
    let mut gpu = Gpu::open();
    let bytes: Vec<u8> = (0..(5 << 20) + 7).map(|index: u32| (index ^ (index >> 11)) as u8).collect();
    let (long, none, short) = (gpu.buffer(&bytes), gpu.buffer::<u64>(&[]), gpu.buffer(&[[1_u32, 2, 3], [4, 5, 6]]));
    let (mut a, mut b, mut c) = (polder_vulkan::room_for::<u8>(bytes.len() + 5), vec![7_u64; 3], vec![[9_u32; 3]]);
    let place = a.as_ptr();
    for _ in 0..2 {
        let downloads = Downloads::new().and(long.view(), &mut a).and(none.view(), &mut b).and(short.view(), &mut c);
        gpu.engine.fetch(downloads).unwrap();
        assert!(a == bytes && b.is_empty() && c == [[1, 2, 3], [4, 5, 6]]);
        assert_eq!(a.as_ptr(), place);
    }
    gpu.device.faults().time_out_at_submission(1);
    let error = gpu.engine.fetch(Downloads::new().and(long.view(), &mut a).and(short.view(), &mut c)).unwrap_err();
    assert!(matches!(error, Error::Timeout { .. }) && a.is_empty() && c.is_empty(), "{error:?}");
    gpu.device.faults().clear();
    assert!(gpu.fetch(long.view()) == bytes);
    let mut other = Gpu::open();
    let foreign = other.buffer(&[1_u32; 4]);
    assert!(matches!(gpu.engine.download_vec(foreign.view()), Err(Error::Recording { command: "download", .. })));
}

#[test]
fn fills_copies_and_views() {
    let mut gpu = Gpu::open();
    let buffer = gpu.buffer(&words(1, 64));
    let before = words(1, 64);
    let mut recording = gpu.recording();
    recording.fill(buffer.slice(4..12).unwrap(), 5);
    recording.copy(buffer.slice(8..16).unwrap(), buffer.slice(32..48).unwrap());
    let read = recording.read(buffer.slice(0..8).unwrap());
    let report = gpu.run(&recording);
    let mut expected = before.clone();
    expected[4..12].fill(5);
    expected.copy_within(8..16, 32);
    assert_eq!(gpu.fetch(buffer.view()), expected);
    assert_eq!(report.words(read), &expected[..8]);
    assert_eq!(buffer.view().cast::<u64>().len(), 32);
    for (start, end) in [(1, 2), (60, 65), (8, 4)] {
        assert!(matches!(buffer.slice(start..end), Err(Error::Range { .. })));
    }
}

#[test]
fn what_cannot_be_is_refused_when_it_runs() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<CopyWords>::new(&gpu.device, &[]).unwrap();
    let (a, b) = (gpu.buffer(&[1_u32; 8]), gpu.buffer(&[1_u32; 4]));
    let arguments = CopyWordsArgs { from: a.view(), to: b.view(), count: 4 };
    let refused: [&dyn Fn(&mut Recording); 6] = [
        &|recording| recording.copy(a.view(), b.view()),
        &|recording| recording.copy(a.view(), a.view()),
        &|recording| recording.dispatch(&kernel, [1, 70_000, 1], &arguments),
        &|recording| recording.dispatch_indirect(&kernel, b.slice(0..2).unwrap(), &arguments),
        &|recording| recording.repeat("none", b.slice(0..0).unwrap(), 1, 1, |_| {}),
        &|recording| recording.repeat("inside", b.view(), 1, 1, |body| body.copy(a.view(), b.view())),
    ];
    for refuse in refused {
        let mut recording = gpu.recording();
        refuse(&mut recording);
        let failed = gpu.engine.run(&recording, &RunOptions::default());
        assert!(matches!(failed, Err(Error::Recording { .. })), "{failed:?}");
    }
    let constant = Kernel::<CopyWords>::new(&gpu.device, &[("NONE", 1)]);
    assert!(matches!(constant, Err(Error::Recording { command: "copy_words", .. })));
    let workgroup = Kernel::<CopyWords>::new(&gpu.device, &[("WORKGROUP", 1 << 20)]);
    assert!(matches!(workgroup, Err(Error::Recording { command: "copy_words", .. })));
    // Of another device.
    let other = Gpu::open();
    let mut recording = other.recording();
    recording.fill(a.view(), 1);
    let failed = gpu.engine.run(&recording, &RunOptions::default());
    assert!(matches!(failed, Err(Error::Recording { .. })), "{failed:?}");
    assert!(gpu.engine.upload(Buffer::<u32>::new(&other.device, "other", 1).unwrap().view(), &[1]).is_err());
    assert!(gpu.engine.upload(b.view(), &[1; 5]).is_err());
    // And nothing of that did any harm.
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, groups_for(4, 4096), &arguments);
    gpu.run(&recording);
}

#[test]
fn every_kernel_is_timed_by_name() {
    let mut gpu = Gpu::open();
    let (scan, sort) = (Scan::new(&gpu.device, 5000).unwrap(), Sort::<u32>::new(&gpu.device, 5000).unwrap());
    let buffer = gpu.buffer(&words(1, 5000));
    let mut recording = gpu.recording();
    scan.record(&mut recording, 5000, buffer.view(), buffer.view(), None);
    sort.record(&mut recording, 5000, buffer.view(), None, 32);
    recording.fill(buffer.view(), 0);
    let options = RunOptions { timestamps: true, ..RunOptions::default() };
    for _ in 0..2 {
        let report = gpu.engine.run(&recording, &options).unwrap();
        let counts: Vec<_> = report.timings.iter().map(|(name, timing)| (name, timing.count)).collect();
        let expected =
            [("fill", 1), ("scan_reduce", 5), ("scan_tiles", 5), ("sort_count_u32", 4), ("sort_move_u32", 4)];
        assert_eq!(counts, expected);
        assert!(report.timings.total().as_nanos() > 0);
        let parsed: serde_json::Value = serde_json::from_str(&report.timings.to_json()).unwrap();
        assert_eq!(parsed["kernels"].as_array().unwrap().len(), 5);
    }
}

#[test]
fn sections_are_timed_across_submissions() {
    let mut gpu = Gpu::open();
    let scan = Scan::new(&gpu.device, 5000).unwrap();
    let (buffer, counter) = (gpu.buffer(&words(1, 5000)), gpu.buffer(&[0_u32; 4]));
    for ahead in [false, true] {
        let mut recording = gpu.recording();
        scan.record(&mut recording, 5000, buffer.view(), buffer.view(), None);
        recording.section("first");
        scan.record(&mut recording, 5000, buffer.view(), buffer.view(), None);
        recording.section("loop");
        let body = |round: &mut Recording| {
            round.section("nothing");
            scan.record(round, 5000, buffer.view(), buffer.view(), None);
        };
        match ahead {
            true => recording.repeat_ahead("loop", counter.view(), 3, 2, 2, body),
            false => recording.repeat("loop", counter.view(), 3, 2, body),
        }
        recording.section("last");
        scan.record(&mut recording, 5000, buffer.view(), buffer.view(), None);
        for timestamps in [false, true] {
            let options = RunOptions { timestamps, ..RunOptions::default() };
            let report = gpu.engine.run(&recording, &options).unwrap();
            let found: Vec<_> = report.sections.iter().map(|(name, timing)| (name, timing.total_ns > 0)).collect();
            assert_eq!(found, [("first", true), ("last", true), ("loop", true)]);
            let scans = |timings: &Timings| timings.get("scan_tiles").map_or(0, |timing| timing.count);
            assert_eq!(scans(&report.timings), if timestamps { 5 } else { 0 });
            let by_section: Vec<_> = report.by_section.iter().map(|(name, timings)| (*name, scans(timings))).collect();
            let expected = [("first", 1), ("last", 1), ("loop", 2)];
            assert_eq!(by_section, if timestamps { &expected[..] } else { &[] });
        }
    }
}

#[test]
fn more_commands_than_one_submission_can_time() {
    let mut gpu = Gpu::open();
    let buffer = gpu.buffer(&[0_u32; 4]);
    let mut recording = gpu.recording();
    for value in 0..5000 {
        recording.fill(buffer.view(), value);
    }
    let options = RunOptions { timestamps: true, ..RunOptions::default() };
    let report = gpu.engine.run(&recording, &options).unwrap();
    assert_eq!((report.timings.get("fill").unwrap().count, report.submissions), (5000, 3));
    assert_eq!(gpu.fetch(buffer.view()), [4999; 4]);
}

#[test]
fn memory_that_was_given_is_taken_and_commands_stay_in_order() {
    let mut gpu = Gpu::open();
    let pool = polder_vulkan::Pool::default();
    let reusing = gpu.device.reusing(&pool);
    let first = Buffer::<u32>::new(&reusing, "first", 4096).unwrap();
    let kept = Buffer::<u32>::new(&gpu.device, "kept", 4096).unwrap();
    first.give(&pool);
    let used = gpu.device.memory_use().used;
    let second = Buffer::<u32>::new(&reusing, "second", 2000).unwrap();
    let third = Buffer::<u32>::new(&reusing, "third", 2000).unwrap();
    assert_eq!(gpu.device.memory_use().used, used);
    let mut recording = gpu.recording();
    recording.fill(first.view(), 5);
    recording.copy(first.view(), kept.view());
    recording.fill(second.view(), 6);
    recording.fill(third.view(), 7);
    gpu.run(&recording);
    assert_eq!(gpu.fetch(kept.view()), [5; 4096]);
    assert_eq!((gpu.fetch(second.view()), gpu.fetch(third.view())), (vec![6; 2000], vec![7; 2000]));
    pool.clear();
    let fourth = Buffer::<u32>::new(&reusing, "fourth", 2000).unwrap();
    assert!(gpu.device.memory_use().used > used && fourth.len() == 2000);
}
