//! Buffers beyond 4 GiB, and numbers of elements beyond 31 bits. For a device with 20 GiB, so by hand.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::kernels::{FillWords, FillWordsArgs};
use polder_vulkan::primitives::{Copier, Operation, Reduce, Scan};
use polder_vulkan::{Buffer, Error, Estimate, Kernel, groups_for};
use std::time::Instant;
use vulkan_support::Gpu;

const GIB: usize = 1 << 30;

/// Kernels reach both ends, by scalars and by fours, through slices and by indices.
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
        let estimate = Estimate::new().buffer::<u32>("large", len);
        estimate.check(&gpu.device).unwrap();
        println!("{gib} GiB: asked for in {:?}", start.elapsed());
        let start = Instant::now();
        let large = Buffer::<u32>::new(&gpu.device, "large", len).unwrap();
        println!("{gib} GiB: allocated in {:?}", start.elapsed());
        let small = Buffer::<u32>::new(&gpu.device, "small", 64).unwrap();
        let result = Buffer::<u32>::new(&gpu.device, "sum", 1).unwrap();
        gpu.engine.upload(small.view(), &[9; 64]).unwrap();

        let mut recording = gpu.recording();
        let whole = FillWordsArgs { to: large.view(), value: 3, count: len as u32 };
        recording.dispatch(&fill, groups_for(len, 4096), &whole);
        let report = gpu.run(&recording);
        assert_eq!(report.dispatches, 1);
        // Both ends, and around every GiB.
        for at in (0..=gib).map(|k| (k * GIB / 4).saturating_sub(16)).chain([len / 4 * 4 - 32]) {
            let part = large.slice(at..len.min(at + 35)).unwrap();
            assert!(gpu.fetch(part).iter().all(|&word| word == 3), "{gib} GiB, at {at}");
        }
        let most = len.min(1 << 31);
        let mut recording = gpu.recording();
        sum.record(&mut recording, most, large.view(), result.view());
        // Through a slice whose address lies beyond 4 GiB.
        let end = large.slice(len / 4 * 4 - 64..len / 4 * 4).unwrap();
        copier.record(&mut recording, small.view(), end);
        let read = recording.read(result.view());
        let report = gpu.run(&recording);
        assert_eq!(report.word(read), (most as u32).wrapping_mul(3), "{gib} GiB");
        assert_eq!(
            gpu.fetch(large.slice(len / 4 * 4 - 68..len).unwrap()),
            [[3; 4].as_slice(), &[9; 64], &[3; 3]].concat()
        );
        // The driver's own fill.
        let mut recording = gpu.recording();
        recording.fill(large.view(), 5);
        gpu.run(&recording);
        assert_eq!(gpu.fetch(large.slice(len / 4 * 4 - 4..len).unwrap()), [5; 7]);
        assert_eq!(gpu.fetch(large.slice(0..4).unwrap()), [5; 4]);
    }
}

#[test]
#[ignore = "needs a device with 20 GiB"]
fn scan_of_the_most() {
    let mut gpu = Gpu::open();
    let len = (1 << 31) - 5;
    let scan = Scan::new(&gpu.device, len).unwrap();
    let words = Buffer::<u32>::new(&gpu.device, "words", len).unwrap();
    let total = Buffer::<u32>::new(&gpu.device, "total", 1).unwrap();
    let mut recording = gpu.recording();
    recording.fill(words.view(), 7);
    scan.record(&mut recording, len, words.view(), words.view(), Some(total.view()));
    let read = recording.read(total.view());
    let report = gpu.run(&recording);
    assert_eq!(report.word(read), (len as u32).wrapping_mul(7));
    for at in [0, GIB / 2, GIB - 16, GIB, GIB + GIB / 2, len / 4 * 4 - 64] {
        let found = gpu.fetch(words.slice(at..at + 64).unwrap());
        let expected: Vec<u32> = (at..at + 64).map(|place| (place as u32).wrapping_mul(7)).collect();
        assert_eq!(found, expected, "{at}");
    }
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
