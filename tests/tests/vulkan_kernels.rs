//! Each kernel of the engine against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::kernels::*;
use polder_vulkan::{Buffer, DeviceOptions, Engine, Kernel, RunOptions, groups_for, reference};
use vulkan_support::{Gpu, options, wide, words};

const WORKGROUP: usize = 256;
const TILE: usize = 16 * WORKGROUP;
const LENGTHS: [usize; 9] = [0, 1, 255, 257, TILE - 1, TILE, TILE + 1, 50_000, 123_457];

fn flags(len: usize) -> Vec<u32> {
    words(len as u64, len).iter().map(|word| if word % 3 == 0 { word | 1 } else { 0 }).collect()
}

#[test]
fn scan_reduce() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<ScanReduce>::new(&gpu.device, &[]).unwrap();
    for len in LENGTHS {
        let input = words(1, len);
        let (words, sums) = (gpu.buffer(&input), gpu.buffer(&vec![0_u32; len.div_ceil(TILE)]));
        let mut recording = gpu.recording();
        let arguments = ScanReduceArgs { words: words.view(), sums: sums.view(), counter: None, limit: len as u32 };
        recording.dispatch(&kernel, groups_for(len, TILE as u32), &arguments);
        gpu.run(&recording);
        assert_eq!(gpu.fetch(sums.view()), reference::scan_reduce(&input, TILE), "{len}");
    }
}

#[test]
fn compact_count() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<CompactCount>::new(&gpu.device, &[]).unwrap();
    for len in LENGTHS {
        let input = flags(len);
        let (words, sums) = (gpu.buffer(&input), gpu.buffer(&vec![0_u32; len.div_ceil(TILE)]));
        let mut recording = gpu.recording();
        let arguments = CompactCountArgs { words: words.view(), sums: sums.view(), counter: None, limit: len as u32 };
        recording.dispatch(&kernel, groups_for(len, TILE as u32), &arguments);
        gpu.run(&recording);
        assert_eq!(gpu.fetch(sums.view()), reference::compact_count(&input, TILE), "{len}");
    }
}

#[test]
fn scan_sums() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<ScanSums>::new(&gpu.device, &[]).unwrap();
    for len in LENGTHS {
        let input = words(2, len);
        let (sums, total) = (gpu.buffer(&input), gpu.buffer(&[7_u32]));
        let mut recording = gpu.recording();
        let arguments = ScanSumsArgs {
            sums: sums.view(),
            total: Some(total.view()),
            counter: None,
            limit: 10 * len as u32,
            tile: 10,
        };
        recording.dispatch(&kernel, [1, 1, 1], &arguments);
        gpu.run(&recording);
        let (expected, all) = reference::scan_sums(&input);
        assert_eq!((gpu.fetch(sums.view()), gpu.fetch(total.view())[0]), (expected, all), "{len}");
    }
}

/// With scanned sums, and with sums as they are: then with the sum of all.
#[test]
fn scan_tiles() {
    let mut gpu = Gpu::open();
    let kernels = [0, 1].map(|raw| Kernel::<ScanTiles>::new(&gpu.device, &[("RAW", raw)]).unwrap());
    for len in LENGTHS {
        let input = words(3, len);
        let raw = reference::scan_reduce(&input, TILE);
        let (base, all) = reference::scan_sums(&raw);
        for (kernel, tiles) in kernels.iter().zip([&base, &raw]) {
            let is_raw = std::ptr::eq(tiles, &raw);
            for with_total in [true, false] {
                let (words, sums, scanned) = (gpu.buffer(&input), gpu.buffer(tiles), gpu.buffer(&vec![7_u32; len]));
                let (total, counter) = (gpu.buffer(&[7_u32]), gpu.buffer(&[len as u32]));
                let arguments = ScanTilesArgs {
                    words: words.view(),
                    scanned: scanned.view(),
                    sums: sums.view(),
                    total: with_total.then(|| total.view()),
                    counter: Some(counter.view()),
                    limit: u32::MAX,
                };
                let mut recording = gpu.recording();
                // Workgroups beyond the end, too.
                recording.dispatch(kernel, groups_for(len + 3 * TILE, TILE as u32), &arguments);
                gpu.run(&recording);
                assert!(gpu.fetch(scanned.view()) == reference::scan_tiles(&input, &base, TILE), "{len}");
                assert_eq!(gpu.fetch(total.view()), [if is_raw && with_total { all } else { 7 }], "{len}");
            }
        }
    }
}

#[test]
fn compact_write() {
    let mut gpu = Gpu::open();
    let kernels = [0, 1].map(|raw| Kernel::<CompactWrite>::new(&gpu.device, &[("RAW", raw)]).unwrap());
    for len in LENGTHS {
        let (flag, value) = (flags(len), words(5, len));
        let raw = reference::compact_count(&flag, TILE);
        let (base, all) = reference::scan_sums(&raw);
        let (flags, values) = (gpu.buffer(&flag), gpu.buffer(&value));
        for (kernel, tiles) in kernels.iter().zip([&base, &raw]) {
            let is_raw = std::ptr::eq(tiles, &raw);
            for with_values in [true, false] {
                let (kept, sums, total) = (gpu.buffer(&vec![7_u32; len]), gpu.buffer(tiles), gpu.buffer(&[7_u32]));
                let mut recording = gpu.recording();
                let arguments = CompactWriteArgs {
                    flags: flags.view(),
                    values: with_values.then(|| values.view()),
                    kept: kept.view(),
                    sums: sums.view(),
                    total: Some(total.view()),
                    counter: None,
                    limit: len as u32,
                };
                recording.dispatch(kernel, groups_for(len + 3 * TILE, TILE as u32), &arguments);
                gpu.run(&recording);
                let mut expected = vec![7; len];
                reference::compact_write(&flag, with_values.then_some(&value), &base, TILE, &mut expected);
                assert!(gpu.fetch(kept.view()) == expected, "{len}");
                assert_eq!(gpu.fetch(total.view()), [if is_raw { all } else { 7 }], "{len}");
            }
        }
    }
}

#[test]
fn reduce() {
    let mut gpu = Gpu::open();
    let narrow = Kernel::<ReduceU32>::new(&gpu.device, &[("OPERATION", 1)]).unwrap();
    let broad = Kernel::<ReduceU64>::new(&gpu.device, &[("OPERATION", 0)]).unwrap();
    for len in LENGTHS {
        let (small, large) = (words(6, len), wide(6, len));
        for groups in [1, 3, 64] {
            let (a, b) = (gpu.buffer(&vec![7_u32; groups]), gpu.buffer(&vec![7_u64; groups]));
            let (small_values, large_values) = (gpu.buffer(&small), gpu.buffer(&large));
            let (counter, limit) = (None, len as u32);
            let mut recording = gpu.recording();
            let arguments = ReduceU32Args { values: small_values.view(), results: a.view(), counter, limit };
            recording.dispatch(&narrow, [groups as u32, 1, 1], &arguments);
            let arguments = ReduceU64Args { values: large_values.view(), results: b.view(), counter, limit };
            recording.dispatch(&broad, [groups as u32, 1, 1], &arguments);
            gpu.run(&recording);
            let expected = reference::reduce(&small, groups, WORKGROUP, u32::MAX, u32::min);
            assert_eq!(gpu.fetch(a.view()), expected, "{len}");
            let expected = reference::reduce(&large, groups, WORKGROUP, 0, u64::wrapping_add);
            assert_eq!(gpu.fetch(b.view()), expected, "{len}");
        }
    }
}

type Constants = Vec<(&'static str, u32)>;

/// Keys in a tile, and the constants of both kernels of a pass.
fn sort_constants(gpu: &Gpu) -> (usize, Constants, Constants) {
    let lanes = gpu.device.info().limits.subgroup;
    let (workgroup, items) = (4 * lanes, 4);
    let shape = vec![("WORKGROUP", workgroup), ("ITEMS", items)];
    let mut moving = shape.clone();
    moving.extend([("SUBGROUP", lanes), ("POOL", (4 * 256).max(2 * workgroup * items))]);
    ((workgroup * items) as usize, shape, moving)
}

#[test]
fn sort_count() {
    let mut gpu = Gpu::open();
    let (tile, shape, _) = sort_constants(&gpu);
    let narrow = Kernel::<SortCountU32>::new(&gpu.device, &shape).unwrap();
    let broad = Kernel::<SortCountU64>::new(&gpu.device, &shape).unwrap();
    for len in LENGTHS {
        let (small, large) = (words(7, len), wide(7, len));
        let (tiles, limit, mask) = (len.div_ceil(tile), len as u32, 127);
        let (a, b) = (gpu.buffer(&vec![7_u32; 256 * tiles]), gpu.buffer(&vec![7_u32; 256 * tiles]));
        let (small_keys, large_keys) = (gpu.buffer(&small), gpu.buffer(&large));
        let (counter, count_tiles) = (None, tiles as u32);
        let mut recording = gpu.recording();
        let keys = small_keys.view();
        let arguments = SortCountU32Args { keys, counts: a.view(), counter, limit, tiles: count_tiles, shift: 8, mask };
        recording.dispatch(&narrow, groups_for(len, tile as u32), &arguments);
        let keys = large_keys.view();
        let arguments =
            SortCountU64Args { keys, counts: b.view(), counter, limit, tiles: count_tiles, shift: 40, mask };
        recording.dispatch(&broad, groups_for(len, tile as u32), &arguments);
        gpu.run(&recording);
        assert!(gpu.fetch(a.view()) == reference::sort_count(&small, tile, 8, mask), "{len}");
        assert!(gpu.fetch(b.view()) == reference::sort_count(&large, tile, 40, mask), "{len}");
    }
}

#[test]
fn sort_move() {
    let mut gpu = Gpu::open();
    let (tile, _, shape) = sort_constants(&gpu);
    let narrow = Kernel::<SortMoveU32>::new(&gpu.device, &shape).unwrap();
    let broad = Kernel::<SortMoveU64>::new(&gpu.device, &shape).unwrap();
    for len in LENGTHS {
        let (small, large, value) = (words(8, len), wide(8, len), words(9, len));
        let (tiles, limit, mask) = (len.div_ceil(tile) as u32, len as u32, 255);
        let (start, _) = reference::exclusive_scan(&reference::sort_count(&small, tile, 24, mask));
        let (wide_start, _) = reference::exclusive_scan(&reference::sort_count(&large, tile, 32, mask));
        let (small_keys, large_keys, values) = (gpu.buffer(&small), gpu.buffer(&large), gpu.buffer(&value));
        let (starts, wide_starts) = (gpu.buffer(&start), gpu.buffer(&wide_start));
        let (a, a_values) = (gpu.buffer(&vec![7_u32; len]), gpu.buffer(&vec![7_u32; len]));
        let (b, b_values) = (gpu.buffer(&vec![7_u64; len]), gpu.buffer(&vec![7_u32; len]));
        let mut recording = gpu.recording();
        let arguments = SortMoveU32Args {
            keys: small_keys.view(),
            values: Some(values.view()),
            moved_keys: a.view(),
            moved_values: Some(a_values.view()),
            starts: starts.view(),
            counter: None,
            limit,
            tiles,
            shift: 24,
            mask,
        };
        recording.dispatch(&narrow, groups_for(len, tile as u32), &arguments);
        let arguments = SortMoveU64Args {
            keys: large_keys.view(),
            values: Some(values.view()),
            moved_keys: b.view(),
            moved_values: Some(b_values.view()),
            starts: wide_starts.view(),
            counter: None,
            limit,
            tiles,
            shift: 32,
            mask,
        };
        recording.dispatch(&broad, groups_for(len, tile as u32), &arguments);
        gpu.run(&recording);
        let expected = reference::sort_move(&small, &value, &start, tile, 24, mask);
        assert!((gpu.fetch(a.view()), gpu.fetch(a_values.view())) == expected, "u32 keys of {len}");
        let expected = reference::sort_move(&large, &value, &wide_start, tile, 32, mask);
        assert!((gpu.fetch(b.view()), gpu.fetch(b_values.view())) == expected, "u64 keys of {len}");
    }
}

#[test]
fn copy_words() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<CopyWords>::new(&gpu.device, &[]).unwrap();
    for len in LENGTHS {
        let from = words(10, len);
        let (source, target) = (gpu.buffer(&from), gpu.buffer(&vec![7_u32; len + 9]));
        let mut recording = gpu.recording();
        let arguments = CopyWordsArgs { from: source.view(), to: target.view(), count: len as u32 };
        recording.dispatch(&kernel, groups_for(len, TILE as u32), &arguments);
        gpu.run(&recording);
        let mut expected = vec![7; len + 9];
        reference::copy_words(&from, &mut expected);
        assert!(gpu.fetch(target.view()) == expected, "{len}");
    }
}

#[test]
fn dispatch_size() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<DispatchSize>::new(&gpu.device, &[]).unwrap();
    let limit = u32::MAX - 10;
    for count in [0, 1, 255, 256, 257, 65535 * 256, 65535 * 256 + 1, 1 << 30, u32::MAX] {
        for items in [1, 256, 4096] {
            let (counter, groups) = (gpu.buffer(&[count]), gpu.buffer(&[7_u32; 3]));
            let mut recording = gpu.recording();
            let arguments = DispatchSizeArgs { counter: Some(counter.view()), groups: groups.view(), limit, items };
            recording.dispatch(&kernel, [1, 1, 1], &arguments);
            gpu.run(&recording);
            assert_eq!(gpu.fetch(groups.view()), reference::dispatch_size(count, limit, items), "{count} by {items}");
        }
    }
}

/// The device's own test compares far more; here, that the kernel and its reference have the same nine results.
#[test]
fn self_test_f64() {
    let mut gpu = Gpu::open();
    if !gpu.device.has(polder_vulkan::Feature::ShaderFloat64) {
        return assert_eq!(gpu.device.self_test().unwrap(), polder_vulkan::SelfTest::NoFloat64);
    }
    assert!(gpu.device.self_test().unwrap().passed(), "{}", gpu.device.self_test().unwrap());
    let kernel = Kernel::<SelfTestF64>::new(&gpu.device, &[]).unwrap();
    let numbers = [1.0, 0.1, -3.75, 1e16 + 2.0, 1e-310, -0.0, 7e200];
    let pairs: Vec<[f64; 2]> = numbers.iter().flat_map(|a| numbers.map(|b| [*a, b])).collect();
    let input = gpu.buffer(bytemuck::cast_slice::<[f64; 2], f64>(&pairs));
    let output = Buffer::<f64>::new(&gpu.device, "results", 9 * pairs.len()).unwrap();
    let mut recording = gpu.recording();
    let count = pairs.len() as u32;
    let arguments = SelfTestF64Args { pairs: input.view(), results: output.view(), count };
    recording.dispatch(&kernel, groups_for(pairs.len(), 64), &arguments);
    gpu.run(&recording);
    for ([a, b], found) in pairs.iter().zip(gpu.fetch(output.view()).chunks_exact(9)) {
        for (expected, found) in reference::self_test_f64(*a, *b).iter().zip(found) {
            assert!(expected.to_bits() == found.to_bits() || (expected.is_nan() && found.is_nan()), "{a:e}, {b:e}");
        }
    }
}

/// Of buffers that are there and of those that are gone; and what lies beside them is whole.
#[test]
fn writes_past_the_end_are_told() {
    let gpu = Gpu::with(&DeviceOptions { guarded: true, ..options() });
    let mut engine = Engine::new(&gpu.device).unwrap();
    let kernel = Kernel::<FillWords>::new(&gpu.device, &[]).unwrap();
    let buffers: Vec<Buffer<u32>> =
        ["left", "middle", "right"].map(|name| Buffer::new(&gpu.device, name, 64).unwrap()).into();
    let mut fill = |buffer: &Buffer<u32>, count| {
        let mut recording = gpu.recording();
        let to = buffer.view();
        recording.dispatch(&kernel, [1, 1, 1], &FillWordsArgs { to, value: 3, count });
        engine.run(&recording, &RunOptions::default()).unwrap();
    };
    buffers.iter().for_each(|buffer| fill(buffer, 64));
    assert_eq!(gpu.device.overruns(), Vec::<String>::new());
    fill(&buffers[1], 70);
    let told = ["buffer `middle` of 256 bytes: written 0 bytes behind its end"];
    assert_eq!(gpu.device.overruns(), told);
    for buffer in [&buffers[0], &buffers[2]] {
        assert_eq!(engine.download_vec(buffer.view()).unwrap(), [3; 64]);
    }
    let device = gpu.device.clone();
    drop(buffers);
    assert_eq!(device.overruns(), told);
    // Dropped as such, a device of the tests would fail them.
    std::mem::forget(gpu);
}
