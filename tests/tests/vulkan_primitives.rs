//! Each primitive of the engine against its reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::primitives::{Compact, Copier, Count, Operation, Reduce, Scan, Sort, SortShape};
use polder_vulkan::{Buffer, reference};
use vulkan_support::{Gpu, lengths, wide, words};

#[test]
fn scan_of_any_length() {
    let mut gpu = Gpu::open();
    let scan = Scan::new(&gpu.device, 1 << 20).unwrap();
    for len in lengths() {
        let input = words(len as u64, len);
        let (expected, expected_total) = reference::exclusive_scan(&input);
        let buffer = gpu.buffer(&input);
        let output = gpu.buffer(&vec![7_u32; len]);
        let total = gpu.buffer(&[9_u32]);
        let mut recording = gpu.recording();
        scan.record(&mut recording, len, buffer.view(), output.view(), Some(total.view()));
        // And in place, after it.
        scan.record(&mut recording, len, buffer.view(), buffer.view(), None);
        let read = recording.read(total.view());
        let report = gpu.run(&recording);
        assert_eq!(report.word(read), expected_total, "{len}");
        assert!(gpu.fetch(output.view()) == expected, "{len}");
        assert!(gpu.fetch(buffer.view()) == expected, "{len}, in place");
    }
}

#[test]
fn scan_of_a_length_on_the_device_leaves_the_rest() {
    let mut gpu = Gpu::open();
    let capacity = 20_000;
    let scan = Scan::new(&gpu.device, capacity).unwrap();
    let input = words(1, capacity);
    let buffer = gpu.buffer(&input);
    for len in [0, 1, 4095, 4096, 4097, 19_999, 20_000, 20_001, u32::MAX] {
        let used = (len as usize).min(capacity);
        let (mut expected, expected_total) = reference::exclusive_scan(&input[..used]);
        expected.resize(capacity, 7);
        let output = gpu.buffer(&vec![7_u32; capacity]);
        let (counter, total) = (gpu.buffer(&[len]), gpu.buffer(&[9_u32]));
        let count = Count::on_device(counter.view(), capacity);
        let mut recording = gpu.recording();
        scan.record(&mut recording, count, buffer.view(), output.view(), Some(total.view()));
        let read = recording.read(total.view());
        let report = gpu.run(&recording);
        assert_eq!(report.word(read), expected_total, "{len}");
        assert!(gpu.fetch(output.view()) == expected, "{len}");
    }
}

/// Around the length from which on the sums of the tiles are scanned by a kernel of their own.
#[test]
fn scan_and_compaction_of_many_tiles() {
    let mut gpu = Gpu::open();
    let most = (1 << 24) + 1;
    let (scan, compact) = (Scan::new(&gpu.device, most).unwrap(), Compact::new(&gpu.device, most).unwrap());
    let (input, output) = (gpu.buffer(&words(1, most)), gpu.buffer(&vec![7_u32; most]));
    let flags: Vec<u32> = words(1, most).iter().map(|word| word & 1).collect();
    let (flagged, total) = (gpu.buffer(&flags), gpu.buffer(&[9_u32; 8]));
    let first = words(1, most);
    for limit in [1 << 24, most] {
        let mut recording = gpu.recording();
        let (sum, kept) = (total.slice(0..1).unwrap(), total.slice(4..5).unwrap());
        scan.record(&mut recording, limit, input.view(), output.view(), Some(sum));
        let read = recording.read(sum);
        let report = gpu.run(&recording);
        let (expected, all) = reference::exclusive_scan(&first[..limit]);
        assert_eq!((report.word(read), report.dispatches), (all, if limit == most { 3 } else { 2 }));
        assert!(gpu.fetch(output.view())[..limit] == expected, "{limit}");
        let mut recording = gpu.recording();
        compact.record(&mut recording, limit, flagged.view(), None, output.view(), kept);
        let read = recording.read(kept);
        let report = gpu.run(&recording);
        let expected = reference::compact_indices(&flags[..limit]);
        assert_eq!(report.word(read) as usize, expected.len());
        assert!(gpu.fetch(output.view())[..expected.len()] == expected, "{limit}");
    }
}

#[test]
fn compaction_of_any_length() {
    let mut gpu = Gpu::open();
    let compact = Compact::new(&gpu.device, 1 << 20).unwrap();
    for len in lengths() {
        // Few, half, all and none.
        let every = [16, 2, 1, u32::MAX][len % 4];
        let flags: Vec<u32> =
            words(len as u64, len).iter().map(|word| if word % every == 0 { word | 1 } else { 0 }).collect();
        let values = words(len as u64 + 1, len);
        let mut expected = reference::compact(&flags, &values);
        let mut expected_indices = reference::compact_indices(&flags);
        let kept = expected.len();
        expected.resize(len, 7);
        expected_indices.resize(len, 7);
        let (flags, values) = (gpu.buffer(&flags), gpu.buffer(&values));
        let (output, indices) = (gpu.buffer(&vec![7_u32; len]), gpu.buffer(&vec![7_u32; len]));
        let total = gpu.buffer(&[9_u32, 9]);
        let mut recording = gpu.recording();
        compact.record(&mut recording, len, flags.view(), Some(values.view()), output.view(), total.view());
        compact.record(&mut recording, len, flags.view(), None, indices.view(), total.view());
        let read = recording.read(total.view());
        let report = gpu.run(&recording);
        assert_eq!(report.words(read), [kept as u32, 9], "{len}");
        assert!(gpu.fetch(output.view()) == expected, "{len}");
        assert!(gpu.fetch(indices.view()) == expected_indices, "{len}");
    }
}

#[test]
fn reduction_of_any_length() {
    let mut gpu = Gpu::open();
    for operation in [Operation::Sum, Operation::Minimum, Operation::Maximum] {
        let narrow = Reduce::<u32>::new(&gpu.device, operation).unwrap();
        let broad = Reduce::<u64>::new(&gpu.device, operation).unwrap();
        for len in lengths() {
            let (small, large) = (words(len as u64, len), wide(len as u64, len));
            let expected = match operation {
                Operation::Sum => (
                    small.iter().fold(0, |a: u32, b| a.wrapping_add(*b)),
                    large.iter().fold(0, |a: u64, b| a.wrapping_add(*b)),
                ),
                Operation::Minimum => {
                    (small.iter().min().copied().unwrap_or(u32::MAX), large.iter().min().copied().unwrap_or(u64::MAX))
                }
                Operation::Maximum => {
                    (small.iter().max().copied().unwrap_or(0), large.iter().max().copied().unwrap_or(0))
                }
            };
            let (small, large) = (gpu.buffer(&small), gpu.buffer(&large));
            let (a, b) = (gpu.buffer(&[7_u32]), gpu.buffer(&[7_u64]));
            let mut recording = gpu.recording();
            narrow.record(&mut recording, len, small.view(), a.view());
            broad.record(&mut recording, len, large.view(), b.view());
            gpu.run(&recording);
            assert_eq!((gpu.fetch(a.view())[0], gpu.fetch(b.view())[0]), expected, "{operation:?} of {len}");
        }
    }
}

#[test]
fn sort_of_any_length() {
    let mut gpu = Gpu::open();
    let narrow = Sort::<u32>::new(&gpu.device, 1 << 20).unwrap();
    let broad = Sort::<u64>::new(&gpu.device, 1 << 20).unwrap();
    for len in lengths() {
        let (small, large) = (words(len as u64, len), wide(len as u64, len));
        let values: Vec<u32> = (0..len as u32).map(|index| index ^ 0x5555).collect();
        let expected_small = reference::sort(&small, &values, 32);
        let expected_large = reference::sort(&large, &values, 64);
        let (small, large) = (gpu.buffer(&small), gpu.buffer(&large));
        let (small_values, large_values) = (gpu.buffer(&values), gpu.buffer(&values));
        let mut recording = gpu.recording();
        narrow.record(&mut recording, len, small.view(), Some(small_values.view()), 32);
        broad.record(&mut recording, len, large.view(), Some(large_values.view()), 64);
        gpu.run(&recording);
        assert!(gpu.fetch(small.view()) == expected_small.0, "u32 keys of {len}");
        assert!(gpu.fetch(small_values.view()) == expected_small.1, "values of u32 keys of {len}");
        assert!(gpu.fetch(large.view()) == expected_large.0, "u64 keys of {len}");
        assert!(gpu.fetch(large_values.view()) == expected_large.1, "values of u64 keys of {len}");
    }
}

#[test]
fn sort_by_some_bits_is_stable() {
    let mut gpu = Gpu::open();
    let len = 30_011;
    let sort = Sort::<u64>::new(&gpu.device, len).unwrap();
    let keys = wide(3, len);
    let values: Vec<u32> = (0..len as u32).collect();
    for bits in [0, 1, 3, 8, 9, 16, 17, 24, 33, 64] {
        let expected = reference::sort(&keys, &values, bits);
        let (buffer, order) = (gpu.buffer(&keys), gpu.buffer(&values));
        let mut recording = gpu.recording();
        sort.record(&mut recording, len, buffer.view(), Some(order.view()), bits);
        gpu.run(&recording);
        assert!(gpu.fetch(buffer.view()) == expected.0, "{bits} bits");
        assert!(gpu.fetch(order.view()) == expected.1, "{bits} bits");
    }
}

#[test]
fn sort_of_keys_alike_and_alone() {
    let mut gpu = Gpu::open();
    let len = 10_000;
    let sort = Sort::<u32>::new(&gpu.device, len).unwrap();
    let alike: [Vec<u32>; 5] = [
        vec![0; len],
        vec![u32::MAX; len],
        (0..len as u32).collect(),
        (0..len as u32).rev().map(|index| index << 16).collect(),
        (0..len as u32).map(|index| if index % 97 == 0 { u32::MAX } else { index / 1000 }).collect(),
    ];
    for keys in alike {
        let values: Vec<u32> = (0..len as u32).collect();
        let expected = reference::sort(&keys, &values, 32);
        let (with, alone, order) = (gpu.buffer(&keys), gpu.buffer(&keys), gpu.buffer(&values));
        let mut recording = gpu.recording();
        sort.record(&mut recording, len, with.view(), Some(order.view()), 32);
        sort.record(&mut recording, len, alone.view(), None, 32);
        gpu.run(&recording);
        assert!(gpu.fetch(with.view()) == expected.0);
        assert!(gpu.fetch(order.view()) == expected.1);
        assert!(gpu.fetch(alone.view()) == expected.0);
    }
}

#[test]
fn sort_of_a_count_on_the_device_leaves_the_rest() {
    let mut gpu = Gpu::open();
    let capacity = 9_000;
    let sort = Sort::<u32>::new(&gpu.device, capacity).unwrap();
    let keys = words(5, capacity);
    for len in [0, 1, 1023, 1024, 1025, 8_999, 9_000] {
        let values: Vec<u32> = (0..capacity as u32).collect();
        let sorted = reference::sort(&keys[..len], &values[..len], 32);
        let (buffer, order, counter) = (gpu.buffer(&keys), gpu.buffer(&values), gpu.buffer(&[len as u32]));
        let mut recording = gpu.recording();
        let count = Count::on_device(counter.view(), capacity);
        sort.record(&mut recording, count, buffer.view(), Some(order.view()), 32);
        gpu.run(&recording);
        assert!(gpu.fetch(buffer.view())[..len] == sorted.0, "{len}");
        assert!(gpu.fetch(order.view())[..len] == sorted.1, "{len}");
    }
}

#[test]
fn sort_in_other_shapes() {
    let mut gpu = Gpu::open();
    let lanes = gpu.device.info().limits.subgroup;
    let len = 7_777;
    let keys = wide(6, len);
    let values: Vec<u32> = (0..len as u32).collect();
    let expected = reference::sort(&keys, &values, 64);
    for (workgroup, items) in [(lanes, 1), (4 * lanes, 3), (8 * lanes, 4)] {
        let sort = Sort::<u64>::with_shape(&gpu.device, len, SortShape { workgroup, items }).unwrap();
        let (buffer, order) = (gpu.buffer(&keys), gpu.buffer(&values));
        let mut recording = gpu.recording();
        sort.record(&mut recording, len, buffer.view(), Some(order.view()), 64);
        gpu.run(&recording);
        assert!(gpu.fetch(buffer.view()) == expected.0, "{workgroup} x {items}");
        assert!(gpu.fetch(order.view()) == expected.1, "{workgroup} x {items}");
    }
}

#[test]
fn copies_of_any_length() {
    let mut gpu = Gpu::open();
    let copier = Copier::new(&gpu.device).unwrap();
    for len in lengths() {
        let from = words(len as u64, len);
        let source = gpu.buffer(&from);
        let target = gpu.buffer(&vec![7_u32; len + 5]);
        let mut recording = gpu.recording();
        copier.record(&mut recording, source.view(), target.view());
        gpu.run(&recording);
        let found = gpu.fetch(target.view());
        assert!(found[..len] == from && found[len..] == [7; 5], "{len}");
    }
}

#[test]
fn what_does_not_fit_is_an_error() {
    let mut gpu = Gpu::open();
    let scan = Scan::new(&gpu.device, 100).unwrap();
    let short = Buffer::<u32>::new(&gpu.device, "short", 10).unwrap();
    for len in [11, 101] {
        let mut recording = gpu.recording();
        scan.record(&mut recording, len, short.view(), short.view(), None);
        let failed = gpu.engine.run(&recording, &Default::default());
        assert!(matches!(failed, Err(polder_vulkan::Error::Recording { command: "scan", .. })), "{failed:?}");
    }
}
