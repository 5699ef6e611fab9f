//! Points on a line on the device, with constraints among them, against the reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_canonical::gpu::{Line, LineChains};
use polder_canonical::kernels::{
    LineChains as LineChainsKernel, LineChainsArgs, LineHeads, LineHeadsArgs, LineKeys, LineKeysArgs, LineLengths,
    LineLengthsArgs, LineNames, LineNamesArgs, LinePlaces, LinePlacesArgs,
};
use polder_canonical::reference::{self, Axis};
use polder_mesh::DVec2;
use polder_vulkan::{Kernel, Shader, groups_for};
use std::sync::{Mutex, PoisonError};
use vulkan_support::{Gpu, words};

/// Runs a test with a device; the tests of this file make theirs one after the other.
fn with_device(test: impl FnOnce(&mut Gpu)) {
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    test(&mut Gpu::open());
}

/// Runs one kernel over so many items.
fn run<S: Shader>(gpu: &mut Gpu, items: usize, constants: &[(&'static str, u32)], arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, groups_for(items, 256), arguments);
    gpu.run(&recording);
}

fn scanned(counts: &[u32]) -> Vec<u32> {
    let sum = |sum: &mut u32, &count: &u32| Some(std::mem::replace(sum, *sum + count));
    counts.iter().scan(0, sum).collect()
}

/// Points on lines, with duplicates, zeros of both signs, and coordinates of any size.
fn lines() -> Vec<(Vec<DVec2>, Axis)> {
    let mut lines = Vec::new();
    for count in [1, 2, 3, 255, 256, 257, 3000] {
        let words = words(count as u64, count);
        let some = |word: u32| (f64::from(word % 700) - 350.0) * f64::from(word % 3 + 1).powi(600);
        let x = words.iter().map(|&word| some(word) * if word & 4096 == 0 { 1.0 } else { -1.0 });
        let points: Vec<DVec2> = x.map(|x| DVec2::new(x, -7.0)).collect();
        lines.push((points.iter().map(|p| DVec2::new(p.y, p.x)).collect(), Axis::Y));
        lines.push((points, Axis::X));
        lines.push((vec![DVec2::new(3.0, -0.0); count], Axis::X));
    }
    lines
}

#[test]
fn line() {
    with_device(|gpu| {
        for (points, axis) in lines() {
            let line = Line::new(&gpu.device, points.len()).unwrap();
            let (uploaded, representatives) = (gpu.buffer(&points), gpu.buffer(&vec![7_u32; points.len()]));
            let mut recording = gpu.recording();
            let read = line.record(&mut recording, uploaded.view(), axis, representatives.view()).unwrap();
            let vertices = read.vertices(&gpu.run(&recording));
            let found = (gpu.fetch(representatives.view()), vertices);
            assert_eq!(found, reference::line(&points, axis));
            let lowest = |p: &DVec2| points.iter().position(|q| p == q).unwrap() as u32;
            assert_eq!(found.0, points.iter().map(lowest).collect::<Vec<_>>());
        }
    });
}

#[test]
fn line_keys() {
    with_device(|gpu| {
        for (points, axis) in lines() {
            let count = points.len();
            let (input, keys) = (gpu.buffer(&points), gpu.buffer(&vec![7_u64; count]));
            let values = gpu.buffer(&vec![7_u32; count]);
            let arguments = LineKeysArgs {
                points: input.view().cast(),
                keys: keys.view(),
                values: values.view(),
                axis: axis as u32,
                count: count as u32,
            };
            run::<LineKeys>(gpu, count, &[], &arguments);
            assert_eq!((gpu.fetch(keys.view()), gpu.fetch(values.view())), reference::line_keys(&points, axis));
        }
    });
}

#[test]
fn line_heads() {
    with_device(|gpu| {
        for (points, axis) in lines() {
            let mut sorted = reference::line_keys(&points, axis).0;
            sorted.sort_unstable();
            let (keys, flags) = (gpu.buffer(&sorted), gpu.buffer(&vec![7_u32; sorted.len()]));
            let arguments = LineHeadsArgs { keys: keys.view(), flags: flags.view(), count: sorted.len() as u32 };
            run::<LineHeads>(gpu, sorted.len(), &[], &arguments);
            assert_eq!(gpu.fetch(flags.view()), reference::line_heads(&sorted));
        }
    });
}

#[test]
fn line_names() {
    with_device(|gpu| {
        for count in [1_u32, 2, 300, 1000] {
            let (values, all): (Vec<u32>, Vec<u32>) = ((0..count).rev().collect(), (100..100 + count).collect());
            let flags: Vec<u32> = words(count.into(), count as usize).iter().map(|word| word % 2).collect();
            let flags: Vec<u32> =
                flags.into_iter().enumerate().map(|(p, flag)| if p == 0 { 1 } else { flag }).collect();
            let ranks = scanned(&flags);
            let buffers = [&values, &flags, &ranks, &all, &vec![7; count as usize]].map(|data| gpu.buffer(data));
            let arguments = LineNamesArgs {
                values: buffers[0].view(),
                flags: buffers[1].view(),
                ranks: buffers[2].view(),
                heads: buffers[3].view(),
                representatives: buffers[4].view(),
                count,
            };
            run::<LineNames>(gpu, count as usize, &[], &arguments);
            assert_eq!(gpu.fetch(buffers[4].view()), reference::line_names(&values, &flags, &ranks, &all));
        }
    });
}

/// Sorted points of a line: values, flags, ranks, heads.
fn sorted(points: &[DVec2], axis: Axis) -> [Vec<u32>; 4] {
    let (keys, mut values) = reference::line_keys(points, axis);
    values.sort_by_key(|&i| keys[i as usize]);
    let keys: Vec<u64> = values.iter().map(|&i| keys[i as usize]).collect();
    let flags = reference::line_heads(&keys);
    let heads = values.iter().zip(&flags).filter(|(_, flag)| **flag == 1).map(|(&value, _)| value).collect();
    let ranks = scanned(&flags);
    [values, flags, ranks, heads]
}

/// Constraints among so many points, of both directions, some of zero length.
fn constraints(points: usize, count: usize) -> Vec<[u32; 2]> {
    let ends = words(11 + count as u64, 2 * count);
    ends.chunks(2).map(|w| [w[0] % points as u32, if w[0] % 7 == 0 { w[0] } else { w[1] } % points as u32]).collect()
}

#[test]
fn line_places() {
    with_device(|gpu| {
        for (points, axis) in lines() {
            let [values, flags, ranks, _] = sorted(&points, axis);
            let buffers = [&values, &flags, &ranks, &vec![7; points.len()]].map(|data| gpu.buffer(data));
            let arguments = LinePlacesArgs {
                values: buffers[0].view(),
                flags: buffers[1].view(),
                ranks: buffers[2].view(),
                places: buffers[3].view(),
                count: points.len() as u32,
            };
            run::<LinePlaces>(gpu, points.len(), &[], &arguments);
            assert_eq!(gpu.fetch(buffers[3].view()), reference::line_places(&values, &flags, &ranks));
        }
    });
}

#[test]
fn line_lengths() {
    with_device(|gpu| {
        // The last ones have a sum beyond one word, and one workgroup's alone has.
        for (points, count, stretch) in [(5, 1, 1), (300, 255, 3), (70, 257, 1), (900, 3000, 70_000), (9, 256, 1 << 26)]
        {
            let places: Vec<u32> = words(5, points).iter().map(|word| word % points as u32 * stretch).collect();
            let ends = constraints(points, count);
            let (on_device, on_line) = (gpu.buffer(&ends), gpu.buffer(&places));
            let (lengths, totals) = (gpu.buffer(&vec![7_u32; count]), gpu.buffer(&[0_u32; 4]));
            let arguments = LineLengthsArgs {
                ends: on_device.view().cast(),
                places: on_line.view(),
                lengths: lengths.view(),
                totals: totals.view(),
                constraints: count as u32,
                count: points as u32,
            };
            run::<LineLengths>(gpu, count, &[("WORKGROUP", 256)], &arguments);
            let found = gpu.fetch(totals.view());
            let sum = u64::from(found[1]) << 32 | u64::from(found[0]);
            assert_eq!((gpu.fetch(lengths.view()), sum, found[2]), reference::line_lengths(&ends, &places));
            assert!(stretch < 70_000 || sum > u64::from(u32::MAX), "{sum}");
        }
    });
}

#[test]
fn line_chains() {
    with_device(|gpu| {
        for ((points, axis), count) in lines().into_iter().zip([1, 2, 3, 255, 257, 1000].into_iter().cycle()) {
            let [values, flags, ranks, heads] = sorted(&points, axis);
            let places = reference::line_places(&values, &flags, &ranks);
            let ends = constraints(points.len(), count);
            let (lengths, total, through) = reference::line_lengths(&ends, &places);
            let starts = scanned(&[&lengths[..], &[0]].concat());
            let expected = reference::line_chains(&ends, &places, &heads);
            assert_eq!(expected.len() as u64, total);

            // The kernel, in two parts.
            let on_device = gpu.buffer(&ends);
            let [on_line, begins, names] = [&places, &starts, &heads].map(|data| gpu.buffer(data));
            let chains = gpu.buffer(&vec![7_u32; total as usize]);
            let middle = (total as usize / 2).next_multiple_of(4).min(total as usize);
            for part in [0..middle, middle..total as usize].into_iter().filter(|part| !part.is_empty()) {
                let arguments = LineChainsArgs {
                    ends: on_device.view().cast(),
                    places: on_line.view(),
                    starts: begins.view(),
                    heads: names.view(),
                    chains: chains.slice(part.clone()).unwrap(),
                    constraints: count as u32,
                    first: part.start as u32,
                    limit: part.len() as u32,
                };
                run::<LineChainsKernel>(gpu, part.len(), &[], &arguments);
            }
            assert_eq!(gpu.fetch(chains.view()), expected);

            // The whole step.
            let (input, representatives) = (gpu.buffer(&points), gpu.buffer(&vec![7_u32; points.len()]));
            let line = Line::new(&gpu.device, points.len()).unwrap();
            let made = LineChains::new(&gpu.device, points.len(), count).unwrap();
            let mut recording = gpu.recording();
            line.record(&mut recording, input.view(), axis, representatives.view()).unwrap();
            let read = made.record_starts(&mut recording, &line, on_device.view()).unwrap();
            let report = gpu.run(&recording);
            assert_eq!((read.vertices(&report), read.through_vertices(&report)), (total, through));
            assert_eq!(gpu.fetch(made.starts()), starts);
            let chains = gpu.buffer(&vec![7_u32; total as usize]);
            let mut recording = gpu.recording();
            made.record_chains(&mut recording, &line, on_device.view(), chains.view()).unwrap();
            gpu.run(&recording);
            assert_eq!(gpu.fetch(chains.view()), expected);

            let other = LineChains::new(&gpu.device, points.len() + 1, count).unwrap();
            assert!(other.record_starts(&mut recording, &line, on_device.view()).is_err());
            let other = LineChains::new(&gpu.device, points.len(), count + 1).unwrap();
            assert!(other.record_chains(&mut recording, &line, on_device.view(), chains.view()).is_err());
        }
    });
}
