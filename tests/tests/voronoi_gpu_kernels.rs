//! Each kernel of the digital Voronoi diagram against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod voronoi_gpu_support;
mod vulkan_support;

use polder_tests::families;
use polder_voronoi::kernels::*;
use polder_voronoi::reference::{self, kernels};
use polder_voronoi::{DVec2, Diagram, GridMapping, Options, Resolution, Sites};
use polder_vulkan::{Buffer, Kernel, Recording, Shader, groups_for};
use voronoi_gpu_support::{SHORT, Shared, grids, with_device};
use vulkan_support::Gpu;

const NONE: u32 = kernels::NONE;

/// Runs one kernel over so many items.
fn run<S: Shader>(gpu: &mut Gpu, items: usize, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, &[]).unwrap();
    let mut recording: Recording = gpu.recording();
    recording.dispatch(&kernel, groups_for(items, 256), arguments);
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
    let circles = (0..6).map(|seed| {
        let points = polder_io::generate::circle(200 + 40 * seed as usize, seed);
        let options = Resolution::LongerSide(40 + 11 * seed as u32).into();
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
            let owner = gpu.buffer(&vec![NONE; (width * height) as usize]);
            // Also points outside of the grid.
            for scale in [1.0, -3.0, 1e300, 1e-300] {
                let points: Vec<DVec2> = points.iter().map(|&p| scale * p).filter(|p| p.is_finite()).collect();
                gpu.engine.upload(owner.view(), &vec![NONE; owner.len()]).unwrap();
                let (input, pixels) = (gpu.buffer(&points), gpu.buffer(&vec![7_u32; points.len()]));
                let arguments = MapPointsArgs {
                    points: input.view().cast(),
                    pixels: pixels.view(),
                    owner: owner.view(),
                    translation_x,
                    translation_y,
                    exponent: mapping.exponent(),
                    side: mapping.side(),
                    width,
                    height,
                    count: points.len() as u32,
                };
                run::<MapPoints>(gpu, points.len(), &arguments);
                let expected = kernels::map_points(&points, &mapping);
                assert_eq!(gpu.fetch(pixels.view()), words_of(&expected.0), "{name}");
                assert_eq!(gpu.fetch(owner.view()), expected.1, "{name}");
            }
        }
    });
}

#[test]
fn elect_sites() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let width = mapping.width();
            let (input, owner) = kernels::map_points(&points, &mapping);
            let (pixels, owners) = (gpu.buffer(&words_of(&input)), gpu.buffer(&owner));
            let (owned, lost) = (gpu.buffer(&vec![0_u32; owner.len()]), gpu.buffer(&vec![7_u32; input.len()]));
            let arguments = ElectSitesArgs {
                pixels: pixels.view(),
                owner: owners.view(),
                owned: owned.view(),
                lost: lost.view(),
                width,
                count: input.len() as u32,
            };
            run::<ElectSites>(gpu, input.len(), &arguments);
            let expected = kernels::elect_sites(&input, &owner, width);
            assert_eq!((gpu.fetch(owned.view()), gpu.fetch(lost.view())), expected, "{name}");
        }
    });
}

#[test]
fn number_sites() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let width = mapping.width();
            let (input, owner) = kernels::map_points(&points, &mapping);
            let (owned, _) = kernels::elect_sites(&input, &owner, width);
            let (number, _) = polder_vulkan::reference::exclusive_scan(&owned);
            let (pixels, owners, numbers) = (gpu.buffer(&words_of(&input)), gpu.buffer(&owner), gpu.buffer(&number));
            let (order, order_pixels) = (gpu.buffer(&vec![7_u32; input.len()]), gpu.buffer(&vec![7_u32; input.len()]));
            let arguments = NumberSitesArgs {
                pixels: pixels.view(),
                owner: owners.view(),
                number: numbers.view(),
                order: order.view(),
                order_pixels: order_pixels.view(),
                width,
                count: input.len() as u32,
            };
            run::<NumberSites>(gpu, input.len(), &arguments);
            let (mut expected, mut expected_pixels) = (vec![7; input.len()], vec![[7, 0]; input.len()]);
            kernels::number_sites(&input, &owner, &number, width, &mut expected, &mut expected_pixels);
            assert_eq!(gpu.fetch(order.view()), expected, "{name}");
            assert_eq!(gpu.fetch(order_pixels.view()), words_of(&expected_pixels), "{name}");
        }
    });
}

#[test]
fn missing_keys() {
    with_device(|Shared { gpu, .. }| {
        for (name, points, mapping) in mapped() {
            let (input, _) = kernels::map_points(&points, &mapping);
            let missing: Vec<u32> = (0..input.len() as u32).filter(|i| i % 3 == 1).rev().collect();
            let (pixels, list) = (gpu.buffer(&words_of(&input)), gpu.buffer(&missing));
            let (keys, counter) = (gpu.buffer(&vec![7_u32; missing.len() + 2]), gpu.buffer(&[missing.len() as u32]));
            let arguments = MissingKeysArgs {
                pixels: pixels.view(),
                missing: list.view(),
                keys: keys.view(),
                counter: Some(counter.view()),
                limit: input.len() as u32,
                width: mapping.width(),
            };
            run::<MissingKeys>(gpu, input.len(), &arguments);
            let mut expected = kernels::missing_keys(&input, &missing, mapping.width());
            expected.extend([7, 7]);
            assert_eq!(gpu.fetch(keys.view()), expected, "{name}");
        }
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

#[test]
fn advance_round() {
    with_device(|Shared { gpu, .. }| {
        for count in [0, 1, 256, 257, 65535 * 256, 65535 * 256 + 1, 1 << 30] {
            let (counter, groups) = (gpu.buffer(&[count]), gpu.buffer(&[7_u32; 3]));
            let (zeroed, rounds) = (gpu.buffer(&[7_u32]), gpu.buffer(&[4_u32]));
            for rounds in [Some(rounds.view()), None] {
                let (counter, zeroed) = (counter.view(), zeroed.view());
                let arguments = AdvanceRoundArgs { counter, groups: groups.view(), zeroed, rounds, items: 256 };
                run::<AdvanceRound>(gpu, 1, &arguments);
                assert_eq!(gpu.fetch(groups.view()), kernels::advance_round(count, 256), "{count}");
                assert_eq!(gpu.fetch(zeroed), [0]);
            }
            assert_eq!(gpu.fetch(rounds.view()), [4 + u32::from(count > 0)], "{count}");
        }
    });
}

#[path = "voronoi_gpu_support/coloring.rs"]
mod coloring;
#[path = "voronoi_gpu_support/repair.rs"]
mod repair;
