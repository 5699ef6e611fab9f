//! The digital Voronoi diagram on the device against its reference, step by step, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod voronoi_gpu_support;
mod vulkan_support;

use polder_tests::families;
use polder_voronoi::gpu::Stage;
use polder_voronoi::{DVec2, GridMapping, Key, Options, Resolution, Sites, reference};
use polder_vulkan::Error;
use voronoi_gpu_support::{Shared, anywhere, elected, grids, ranked, rings, with_device};
use vulkan_support::Gpu;

/// A list as the device has it: a bit for each.
fn bits_of(list: &[u32], pixels: usize) -> Vec<u32> {
    let mut bits = vec![0; pixels.div_ceil(32)];
    list.iter().for_each(|&index| bits[index as usize / 32] |= 1 << (index % 32));
    bits
}

/// All steps after mapping, each against the reference.
fn assert_colors(shared: &mut Shared, stage: usize, name: &str, sites: &Sites) {
    let (gpu, stage, buffers) = shared.holding(stage, sites);
    let mut recording = gpu.recording();
    stage.record_color(&mut recording, buffers).unwrap();
    gpu.run(&recording);
    let mut expected = reference::color(sites).unwrap();
    assert!(gpu.fetch(buffers.colors()) == expected.colors, "{name}: coloring");

    let mut recording = gpu.recording();
    stage.record_repair(&mut recording, buffers).unwrap();
    let read = buffers.read_counts(&mut recording);
    let counts = read.counts(&gpu.run(&recording));
    reference::debris(&mut expected, sites).unwrap();
    reference::recolor(&mut expected, sites).unwrap();
    assert!(gpu.fetch(buffers.colors()) == expected.colors, "{name}: repaired");
    assert_eq!(counts.debris, expected.debris.len() as u64, "{name}");
    let bits = bits_of(&expected.debris, expected.colors.len());
    assert!(gpu.fetch(buffers.debris_bits().unwrap()) == bits, "{name}: debris");
}

/// The whole stage in one recording.
fn assert_stage(gpu: &mut Gpu, stage: &Stage, name: &str, points: &[DVec2], options: &Options) {
    let mapping = GridMapping::fit(points, options).unwrap();
    let uploaded = gpu.buffer(points);
    let buffers = stage.buffers(points.len(), mapping.size()).unwrap();
    let mut recording = gpu.recording();
    let read = stage.record(&mut recording, &mapping, uploaded.view(), &buffers).unwrap();
    let counts = read.counts(&gpu.run(&recording));
    let expected = reference::diagram(points, options).unwrap();
    assert_eq!(counts, expected.counts, "{name}");
    assert!(gpu.fetch(buffers.order()) == expected.sites.order, "{name}: order");
    assert!(gpu.fetch(buffers.pixels()) == expected.sites.pixels, "{name}: pixels");
    assert!(gpu.fetch(buffers.colors()) == expected.diagram.colors, "{name}: colors");
    let bits = bits_of(&expected.diagram.debris, expected.diagram.colors.len());
    assert!(gpu.fetch(buffers.debris_bits().unwrap()) == bits, "{name}: debris");
}

#[test]
fn every_family_step_by_step() {
    with_device(|shared| {
        for (name, pslg) in families(1000, 21) {
            let output = reference::diagram(pslg.points(), &Options::default()).unwrap();
            for stage in [0, 1, 2] {
                assert_colors(shared, stage, name, &output.sites);
            }
        }
    });
}

#[test]
fn every_family_in_one_recording() {
    with_device(|Shared { gpu, stages, .. }| {
        for (name, pslg) in families(1000, 22) {
            for options in [Options::default(), Resolution::LongerSide(40).into()] {
                assert_stage(gpu, &stages[0], name, pslg.points(), &options);
            }
        }
    });
}

#[test]
fn every_number_of_points_around_a_workgroup() {
    with_device(|Shared { gpu, stages, .. }| {
        for count in [1, 2, 3, 255, 256, 257, 4095, 4097] {
            let points = polder_io::generate::uniform(count, count as u64);
            assert_stage(gpu, &stages[0], "uniform", points.points(), &Options::default());
        }
    });
}

#[test]
fn strips_lines_empty_rows_dense_and_sparse_grids() {
    with_device(|shared| {
        for (turn, (name, sites)) in grids().into_iter().enumerate() {
            // Most grids are smaller than the long bands.
            let stages: &[usize] = if turn % 5 == 0 || sites.size[0] > 100 { &[0, 1, 2] } else { &[1] };
            for &stage in stages {
                assert_colors(shared, stage, &name, &sites);
            }
        }
    });
}

#[test]
fn the_longest_sides() {
    with_device(|shared| {
        for size in [[32768, 1], [1, 32768], [32768, 3], [3, 32768]] {
            for (seed, count) in [1, 3, 500, 20_000].into_iter().enumerate() {
                assert_colors(shared, 0, "long", &anywhere(size, count, seed as u64));
            }
            let far = elected(size, &[[0, 0], size.map(|side| side as u16 - 1)]);
            assert_colors(shared, 0, "far ends", &far);
        }
    });
}

#[test]
fn small_grids_are_colored_as_by_comparing_all() {
    with_device(|shared| {
        for seed in 0..24 {
            let size = [1 + seed as u32 * 5 % 47, 1 + seed as u32 * 11 % 43];
            let sites = anywhere(size, 1 + seed as usize * 3, 900 + seed);
            for stage in [0, 1, 2] {
                let (gpu, stage, buffers) = shared.holding(stage, &sites);
                let mut recording = gpu.recording();
                stage.record_color(&mut recording, buffers).unwrap();
                gpu.run(&recording);
                let nearest = |index: u32| {
                    let pixel = [(index % size[0]) as u16, (index / size[0]) as u16];
                    (0..sites.count as u32).min_by_key(|&site| Key::of(pixel, sites.pixels[site as usize])).unwrap()
                };
                let expected: Vec<u32> = (0..size[0] * size[1]).map(nearest).collect();
                assert_eq!(gpu.fetch(buffers.colors()), expected, "{seed}");
            }
        }
    });
}

#[test]
fn repaired_grids_are_flooded_as_defined() {
    with_device(|shared| {
        let mut repaired = 0;
        // A thin arc leaves much debris.
        for seed in 0..12 {
            let points = polder_io::generate::circle(150 + 20 * seed as usize, seed);
            let options = Resolution::LongerSide(30 + 9 * seed as u32).into();
            let sites = reference::diagram(points.points(), &options).unwrap().sites;
            let (gpu, stage, buffers) = shared.holding(1, &sites);
            let mut recording = gpu.recording();
            stage.record_color(&mut recording, buffers).unwrap();
            stage.record_repair(&mut recording, buffers).unwrap();
            let read = buffers.read_counts(&mut recording);
            repaired += read.counts(&gpu.run(&recording)).debris;
            let flooded = reference::flooding::flood(&sites).unwrap().diagram;
            assert!(gpu.fetch(buffers.colors()) == flooded.colors, "{seed}");
        }
        assert!(repaired > 100, "{repaired} pixels of debris are too few to show anything");
    });
}

#[test]
fn debris_is_found_and_recolored_where_sites_are_near() {
    with_device(|shared| {
        for (radius, stage) in [(16.0, 0), (16.0, 1), (22.0, 0), (22.0, 2)] {
            let sites = rings([300, 280], radius);
            let debris = {
                let mut diagram = reference::color(&sites).unwrap();
                reference::debris(&mut diagram, &sites).unwrap();
                diagram.debris.len()
            };
            assert!(debris > 10, "{debris}");
            assert_colors(shared, stage, "rings", &sites);
        }
        // Most of it without bands, in the first stage.
        let (gpu, stage, buffers) = shared.holding(0, &rings([300, 280], 16.0));
        let mut recording = gpu.recording();
        stage.record_color(&mut recording, buffers).unwrap();
        let read = buffers.read_counts(&mut recording);
        assert!(read.tiles_left(&gpu.run(&recording)) < 10);
    });
}

#[test]
fn a_recording_serves_again() {
    with_device(|Shared { gpu, stages, .. }| {
        let size = [90, 70];
        let buffers = stages[0].buffers(400, size).unwrap();
        let mut recording = gpu.recording();
        stages[0].record_color(&mut recording, &buffers).unwrap();
        stages[0].record_repair(&mut recording, &buffers).unwrap();
        for seed in 1..4 {
            let sites = anywhere(size, 400, seed);
            gpu.engine.upload(buffers.pixels(), &sites.pixels).unwrap();
            let (bits, ranks) = ranked(&sites);
            gpu.engine.upload(buffers.site_bits(), &bits).unwrap();
            gpu.engine.upload(buffers.site_ranks(), &ranks).unwrap();
            gpu.run(&recording);
            let mut expected = reference::color(&sites).unwrap();
            reference::debris(&mut expected, &sites).unwrap();
            reference::recolor(&mut expected, &sites).unwrap();
            assert!(gpu.fetch(buffers.colors()) == expected.colors, "{seed}");
        }
    });
}

#[test]
fn results_outlive_their_scratch_memory() {
    with_device(|Shared { gpu, stages, .. }| {
        let points = polder_io::generate::uniform(5000, 3);
        let expected = reference::diagram(points.points(), &Options::default()).unwrap();
        let size = expected.mapping.size();
        let uploaded = gpu.buffer(points.points());
        let before = gpu.device.memory_use().used;
        let buffers = stages[0].buffers(5000, size).unwrap();
        let all = gpu.device.memory_use().used - before;
        let mut recording = gpu.recording();
        stages[0].record(&mut recording, &expected.mapping, uploaded.view(), &buffers).unwrap();
        gpu.run(&recording);
        drop(recording);
        let results = buffers.into_results();
        let kept = gpu.device.memory_use().used - before;
        assert!(kept > 0 && kept < all / 2, "{kept} of {all}");
        assert_eq!(results.size(), size);
        assert!(gpu.fetch(results.order()) == expected.sites.order);
        assert!(gpu.fetch(results.pixels()) == expected.sites.pixels);
        assert!(gpu.fetch(results.colors()) == expected.diagram.colors);
        assert_eq!(gpu.fetch(results.site_count().unwrap()), [expected.sites.count as u32]);
    });
}

#[test]
fn what_does_not_fit_is_refused() {
    with_device(|Shared { gpu, stages, .. }| {
        let stage = &stages[0];
        for (points, size) in [(0, [4, 4]), ((1 << 28) + 1, [4, 4]), (1, [0, 4]), (1, [4, 32769])] {
            assert!(matches!(stage.buffers(points, size), Err(Error::Recording { .. })), "{points} {size:?}");
        }
        let used = gpu.device.memory_use().used;
        let needed = stage.estimate(1 << 28, [32768, 32768]).bytes();
        match stage.buffers(1 << 28, [32768, 32768]) {
            Err(Error::TooLarge { .. }) => assert_eq!(gpu.device.memory_use().used, used),
            // Then it must be a very large device.
            other => assert!(other.is_ok() && needed > 1 << 34),
        }
        let points = [DVec2::ZERO, DVec2::ONE];
        let mapping = GridMapping::fit(&points, &Options::default()).unwrap();
        let uploaded = gpu.buffer(&points);
        let mut recording = gpu.recording();
        let buffers = stage.buffers(3, mapping.size()).unwrap();
        assert!(stage.record(&mut recording, &mapping, uploaded.view(), &buffers).is_err());
        let buffers = stage.buffers(2, [mapping.width() + 1, mapping.height()]).unwrap();
        assert!(stage.record(&mut recording, &mapping, uploaded.view(), &buffers).is_err());
        assert!(recording.is_empty());
    });
}
