//! Buffers beyond 4 GiB, and the longest arguments of kernels. For a device with 20 GiB, so by hand.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::kernels::{FillWords, FillWordsArgs};
use polder_vulkan::primitives::{Compact, Copier, MOST, Operation, Reduce, Scan, Sort};
use polder_vulkan::{Buffer, Error, Estimate, Kernel, RunOptions, groups_for};
use std::time::Instant;
use vulkan_support::{Gpu, words};

const GIB: usize = 1 << 30;
/// Words that a kernel reaches.
const REACH: usize = GIB;

/// Kernels reach every part, through slices of 4 GiB at most.
#[test]
#[ignore = "needs a device with 20 GiB"]
fn buffers_beyond_four_gib() {
    let mut gpu = Gpu::open();
    println!("{}", gpu.device.info());
    let fill = Kernel::<FillWords>::new(&gpu.device, &[]).unwrap();
    let copier = Copier::new(&gpu.device).unwrap();
    let sum = Reduce::<u32>::new(&gpu.device, Operation::Sum).unwrap();
    for gib in [5, 9] {
        // Three words more than whole fours.
        let len = gib * GIB / 4 + 3;
        let start = Instant::now();
        Estimate::new().buffer::<u32>("large", len).check(&gpu.device).unwrap();
        let asked = start.elapsed();
        let start = Instant::now();
        let large = Buffer::<u32>::new(&gpu.device, "large", len).unwrap();
        println!("{gib} GiB: asked for in {asked:?}, allocated in {:?}", start.elapsed());

        let whole = FillWordsArgs { to: large.view(), value: 3, count: len as u32 };
        let mut recording = gpu.recording();
        recording.dispatch(&fill, groups_for(len, 4096), &whole);
        let refused = gpu.engine.run(&recording, &RunOptions::default());
        assert!(matches!(refused, Err(Error::Recording { command: "fill_words", .. })), "{refused:?}");

        // The driver's own fill does all; kernels then part by part, with a number for each.
        let parts: Vec<_> = (0..len).step_by(REACH).map(|at| at..len.min(at + REACH)).collect();
        let results = Buffer::<u32>::new(&gpu.device, "sums", 4 * parts.len()).unwrap();
        let mut recording = gpu.recording();
        recording.fill(large.view(), 5);
        for (number, part) in parts.iter().enumerate() {
            let to = large.slice(part.clone()).unwrap();
            let place = results.slice(4 * number..4 * number + 1).unwrap();
            sum.record(&mut recording, part.len(), to, place);
            let arguments = FillWordsArgs { to, value: 100 + number as u32, count: part.len() as u32 };
            recording.dispatch(&fill, groups_for(part.len(), 4096), &arguments);
        }
        let read = recording.read(results.view());
        let report = gpu.run(&recording);
        for (number, part) in parts.iter().enumerate() {
            assert_eq!(report.words(read)[4 * number], (part.len() as u32).wrapping_mul(5), "{gib} GiB, part {number}");
        }
        for at in (0..=4 * gib).map(|k| (k * GIB / 16).saturating_sub(16)).chain([len / 4 * 4 - 32]) {
            let range = at..len.min(at + 35);
            let expected: Vec<u32> = range.clone().map(|place| 100 + (place / REACH) as u32).collect();
            assert_eq!(gpu.fetch(large.slice(range).unwrap()), expected, "{gib} GiB, at {at}");
        }
        // From the front to the end.
        let data = words(7, 1 << 16);
        let to = len / 4 * 4 - data.len();
        gpu.engine.upload(large.view(), &data).unwrap();
        let mut recording = gpu.recording();
        let (front, end) = (large.slice(0..data.len()).unwrap(), large.slice(to..to + data.len()).unwrap());
        copier.record(&mut recording, front, end);
        gpu.run(&recording);
        assert!(gpu.fetch(end) == data);
    }
}

/// Arguments of exactly 4 GiB.
#[test]
#[ignore = "needs a device with 20 GiB"]
fn primitives_of_the_most() {
    let mut gpu = Gpu::open();
    let len = MOST;
    let words = Buffer::<u32>::new(&gpu.device, "words", len).unwrap();
    let total = Buffer::<u32>::new(&gpu.device, "total", 1).unwrap();
    let places = [0, 16, GIB / 4, GIB / 2 - 32, GIB / 2 + 64, 3 * (GIB / 4), len - 64];
    {
        let scan = Scan::new(&gpu.device, len).unwrap();
        let mut recording = gpu.recording();
        recording.fill(words.view(), 7);
        scan.record(&mut recording, len, words.view(), words.view(), Some(total.view()));
        let read = recording.read(total.view());
        assert_eq!(gpu.run(&recording).word(read), (len as u32).wrapping_mul(7));
        for at in places {
            let expected: Vec<u32> = (at..at + 64).map(|place| (place as u32).wrapping_mul(7)).collect();
            assert_eq!(gpu.fetch(words.slice(at..at + 64).unwrap()), expected, "{at}");
        }
    }
    {
        let compact = Compact::new(&gpu.device, len).unwrap();
        let kept = Buffer::<u32>::new(&gpu.device, "kept", len).unwrap();
        let mut recording = gpu.recording();
        compact.record(&mut recording, len, words.view(), None, kept.view(), total.view());
        let read = recording.read(total.view());
        // Seven times a number below 2^30 is zero modulo 2^32 for zero alone.
        assert_eq!(gpu.run(&recording).word(read), len as u32 - 1);
        for at in &places[..places.len() - 1] {
            let expected: Vec<u32> = (*at..at + 64).map(|place| place as u32 + 1).collect();
            assert_eq!(gpu.fetch(kept.slice(*at..at + 64).unwrap()), expected, "{at}");
        }
    }
    // Keys as the scan left them: seven times the index, modulo 2^32. Sorted, they are the multiples that wrapped around.
    let sort = Sort::<u32>::new(&gpu.device, len).unwrap();
    let largest = Reduce::<u32>::new(&gpu.device, Operation::Maximum).unwrap();
    let mut recording = gpu.recording();
    sort.record(&mut recording, len, words.view(), None, 32);
    largest.record(&mut recording, len, words.view(), total.view());
    let read = recording.read(total.view());
    let most = gpu.run(&recording).word(read);
    for at in places {
        let found = gpu.fetch(words.slice(at..at + 64).unwrap());
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{at}");
    }
    let inverse = 3_067_833_783_u32; // of 7 modulo 2^32
    assert_eq!(inverse.wrapping_mul(7), 1);
    let is_key = |key: u32| (key.wrapping_mul(inverse) as usize) < len;
    // A quarter of all words are keys: the place of one is how many are below it.
    assert_eq!(most, (0..).map(|below: u32| u32::MAX - below).find(|&key| is_key(key)).unwrap());
    let first = gpu.fetch(words.slice(0..4096).unwrap());
    assert_eq!(first, (0..).filter(|&key| is_key(key)).take(4096).collect::<Vec<u32>>());
}

/// Whatever the driver gives, what it does not give is an error before anything is held.
#[test]
#[ignore = "takes what memory there is"]
fn more_than_there_is() {
    let gpu = Gpu::open();
    let before = gpu.device.memory_use().used;
    let available = gpu.device.available_memory();
    let len = (available / 4 + 1024) as usize;
    for attempt in [
        Estimate::new().buffer::<u32>("most", len).check(&gpu.device),
        Estimate::new().buffer::<u32>("half", len / 2).buffer::<u32>("other half", len / 2 + 1024).check(&gpu.device),
        Estimate::new().buffer::<u64>("endless", usize::MAX).check(&gpu.device),
    ] {
        match attempt {
            Err(Error::TooLarge { needed, available, .. }) => assert!(needed > available),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(gpu.device.memory_use().used, before);
    let refused = Buffer::<u32>::new(&gpu.device, "most", len);
    assert!(matches!(refused, Err(Error::TooLarge { .. } | Error::OutOfMemory { .. })), "{refused:?}");
    assert_eq!(gpu.device.memory_use().used, before);
}
