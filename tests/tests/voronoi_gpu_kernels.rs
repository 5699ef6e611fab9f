//! Each kernel of the digital Voronoi diagram against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod voronoi_gpu_support;
mod vulkan_support;

use polder_tests::families;
use polder_voronoi::kernels::*;
use polder_voronoi::reference::{self, kernels};
use polder_voronoi::{DVec2, Diagram, GridMapping, Options, Resolution, Sites, UNCOLORED};
use polder_vulkan::{Buffer, Kernel, Recording, Shader, groups_for};
use voronoi_gpu_support::{SHORT, Shared, grids, ranked, rings, with_device};
use vulkan_support::Gpu;

const NONE: u32 = kernels::NONE;

/// Runs one kernel over so many items.
fn run<S: Shader>(gpu: &mut Gpu, items: usize, arguments: &S::Args<'_>) {
    run_with::<S>(gpu, &[], groups_for(items, 256), arguments);
}

fn run_with<S: Shader>(gpu: &mut Gpu, constants: &[(&'static str, u32)], groups: [u32; 3], arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording: Recording = gpu.recording();
    recording.dispatch(&kernel, groups, arguments);
    gpu.run(&recording);
}

/// Points of every family, and the grid that they are mapped to.
fn mapped() -> Vec<(&'static str, Vec<DVec2>, GridMapping)> {
    let fine = Options::default();
    let coarse = Resolution::LongerSide(17).into();
    let fit = |(name, points): (&'static str, Vec<DVec2>), options| {
        let mapping = GridMapping::fit(&points, options).unwrap();
        (name, points, mapping)
    };
    let all = |seed| families(700, seed).into_iter().map(|(name, pslg)| (name, pslg.points().to_vec()));
    all(31).map(|case| fit(case, &fine)).chain(all(32).map(|case| fit(case, &coarse))).collect()
}

/// Pixels as the words that kernels see.
fn words_of(pixels: &[[u16; 2]]) -> Vec<u32> {
    pixels.iter().map(|&[x, y]| u32::from(y) << 16 | u32::from(x)).collect()
}

/// Diagrams with debris in them, colored as by distance; and some without.
fn diagrams() -> Vec<(Sites, Diagram)> {
    let circles = (0..8).map(|seed| {
        let points = polder_io::generate::circle(200 + 40 * seed as usize + if seed > 5 { 20_000 } else { 0 }, seed);
        let options = Resolution::LongerSide(40 + 11 * seed as u32 + if seed > 5 { 200 } else { 0 }).into();
        reference::diagram(points.points(), &options).unwrap().sites
    });
    let others = grids().into_iter().step_by(9).map(|(_, sites)| sites);
    let colored = |sites: Sites| (reference::color(&sites).unwrap(), sites);
    circles.chain(others).map(colored).map(|(diagram, sites)| (sites, diagram)).collect()
}

fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list
}

#[test]
fn map_points() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let [width, height] = mapping.size();
            let [translation_x, translation_y] = mapping.translation();
            let ([exponent_x, exponent_y], [side_x, side_y]) = (mapping.exponents(), mapping.sides());
            let bits = gpu.buffer(&vec![0_u32; (width.div_ceil(32) * height) as usize]);
            // Also points outside of the grid.
            for scale in [1.0, -3.0, 1e300, 1e-300] {
                let points: Vec<DVec2> = points.iter().map(|&p| scale * p).filter(|p| p.is_finite()).collect();
                gpu.engine.upload(bits.view(), &vec![0; bits.len()]).unwrap();
                let (input, pixels) = (gpu.buffer(&points), gpu.buffer(&vec![7_u32; points.len()]));
                let arguments = MapPointsArgs {
                    points: input.view().cast(),
                    pixels: pixels.view(),
                    bits: bits.view(),
                    translation_x,
                    translation_y,
                    exponent_x,
                    exponent_y,
                    side_x,
                    side_y,
                    width,
                    height,
                    count: points.len() as u32,
                };
                run::<MapPoints>(gpu, points.len(), &arguments);
                let expected = kernels::map_points(&points, &mapping);
                assert_eq!(gpu.fetch(pixels.view()), words_of(&expected.0), "{name}");
                assert_eq!(gpu.fetch(bits.view()), expected.1, "{name}");
            }
        }
    });
}

#[test]
fn count_bits() {
    with_device(|Shared { gpu, .. }| {
        for count in [1, 255, 256, 257, 5000] {
            let input = vulkan_support::words(count as u64, count);
            let (words, counts) = (gpu.buffer(&input), gpu.buffer(&vec![7_u32; count]));
            let arguments = CountBitsArgs { words: words.view(), counts: counts.view(), count: count as u32 };
            run::<CountBits>(gpu, count, &arguments);
            assert_eq!(gpu.fetch(counts.view()), kernels::count_bits(&input));
        }
    });
}

/// What the kernels after the first scan read: pixels of points, bits, ranks; and the bits of the points that lost.
struct Ranked {
    pixels: Vec<[u16; 2]>,
    bits: Vec<u32>,
    ranks: Vec<u32>,
    order: Vec<u32>,
    lost: Vec<u32>,
}

impl Ranked {
    fn new(points: &[DVec2], mapping: &GridMapping) -> Self {
        let (pixels, bits) = kernels::map_points(points, mapping);
        let (ranks, _) = polder_vulkan::reference::exclusive_scan(&kernels::count_bits(&bits));
        let (order, lost) = kernels::elect_sites(&pixels, &bits, &ranks, mapping.width());
        Ranked { pixels, bits, ranks, order, lost }
    }
}

#[test]
fn elect_sites() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let ranked = Ranked::new(&points, &mapping);
            let count = points.len();
            let pixels = gpu.buffer(&words_of(&ranked.pixels));
            let (bits, ranks) = (gpu.buffer(&ranked.bits), gpu.buffer(&ranked.ranks));
            let (order, lost) = (gpu.buffer(&vec![NONE; count]), gpu.buffer(&vec![0_u32; count.div_ceil(32)]));
            let arguments = ElectSitesArgs {
                pixels: pixels.view(),
                bits: bits.view(),
                ranks: ranks.view(),
                order: order.view(),
                lost: lost.view(),
                width: mapping.width(),
                count: count as u32,
            };
            run::<ElectSites>(gpu, count, &arguments);
            assert_eq!(gpu.fetch(order.view()), ranked.order, "{name}");
            assert_eq!(gpu.fetch(lost.view()), ranked.lost, "{name}");
        }
    });
}

#[test]
fn list_sites() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let (input, counts) = ranked(&sites);
            let (bits, ranks) = (gpu.buffer(&input), gpu.buffer(&counts));
            let order_pixels = gpu.buffer(&vec![7_u32; sites.count]);
            let [width, height] = sites.size;
            let arguments = ListSitesArgs {
                bits: bits.view(),
                ranks: ranks.view(),
                order_pixels: order_pixels.view(),
                width,
                height,
            };
            run::<ListSites>(gpu, input.len(), &arguments);
            let expected = kernels::list_sites(&input, width);
            assert_eq!(expected, sites.pixels[..sites.count], "{name}");
            assert_eq!(gpu.fetch(order_pixels.view()), words_of(&expected), "{name}");
        }
    });
}

#[test]
fn list_missing() {
    with_device(|Shared { gpu, .. }| {
        let mut found = 0;
        for (name, points, mapping) in mapped() {
            let ranked = Ranked::new(&points, &mapping);
            let width = mapping.width();
            let (lost_ranks, total) = polder_vulkan::reference::exclusive_scan(&kernels::count_bits(&ranked.lost));
            let (lost, lost_ranks) = (gpu.buffer(&ranked.lost), gpu.buffer(&lost_ranks));
            let pixels = gpu.buffer(&words_of(&ranked.pixels));
            let (bits, ranks) = (gpu.buffer(&ranked.bits), gpu.buffer(&ranked.ranks));
            let room = total as usize + 2;
            let (missing, keys) = (gpu.buffer(&vec![7_u32; room]), gpu.buffer(&vec![7_u32; room]));
            let arguments = ListMissingArgs {
                lost: lost.view(),
                lost_ranks: lost_ranks.view(),
                pixels: pixels.view(),
                bits: bits.view(),
                ranks: ranks.view(),
                missing: missing.view(),
                keys: keys.view(),
                width,
                count: points.len() as u32,
            };
            run::<ListMissing>(gpu, points.len(), &arguments);
            let mut expected = kernels::list_missing(&ranked.lost, &ranked.pixels, &ranked.bits, &ranked.ranks, width);
            found += expected.0.len();
            expected.0.extend([7, 7]);
            expected.1.extend([7, 7]);
            assert_eq!((gpu.fetch(missing.view()), gpu.fetch(keys.view())), expected, "{name}");
        }
        assert!(found > 1000, "{found}");
    });
}

#[test]
fn number_missing() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let (input, _) = kernels::map_points(&points, &mapping);
            let missing: Vec<u32> = (0..input.len() as u32).filter(|i| i % 3 == 1).rev().collect();
            let before = input.len() - missing.len();
            let (pixels, list) = (gpu.buffer(&words_of(&input)), gpu.buffer(&missing));
            let (sites, counter) = (gpu.buffer(&[before as u32]), gpu.buffer(&[missing.len() as u32]));
            let (order, order_pixels) = (gpu.buffer(&vec![7_u32; input.len()]), gpu.buffer(&vec![7_u32; input.len()]));
            let arguments = NumberMissingArgs {
                pixels: pixels.view(),
                missing: list.view(),
                sites: sites.view(),
                order: order.view(),
                order_pixels: order_pixels.view(),
                counter: Some(counter.view()),
                limit: input.len() as u32,
            };
            run::<NumberMissing>(gpu, input.len(), &arguments);
            let (mut expected, mut expected_pixels) = (vec![7; input.len()], vec![[7, 0]; input.len()]);
            kernels::number_missing(&input, &missing, before, &mut expected, &mut expected_pixels);
            assert_eq!(gpu.fetch(order.view()), expected, "{name}");
            assert_eq!(gpu.fetch(order_pixels.view()), words_of(&expected_pixels), "{name}");
        }
    });
}

#[path = "voronoi_gpu_support/coloring.rs"]
mod coloring;
#[path = "voronoi_gpu_support/repair.rs"]
mod repair;
