//! How much of their box points fill, on the device and on the host, and the grid that comes of it.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_io::generate;
use polder_tests::families;
use polder_voronoi::gpu::{FindBounds, FindOccupancy};
use polder_voronoi::kernels::{CountCells, CountCellsArgs, MarkCells, MarkCellsArgs};
use polder_voronoi::reference::{self, bound_partials, bound_points};
use polder_voronoi::{Bounds, DVec2, GridMapping, Occupancy, Options};
use polder_vulkan::{Kernel, groups_for};
use vulkan_support::{Gpu, wide, words};

const SIDE: usize = 2048;

/// Points of all magnitudes, in a wide box, a narrow one, and one of a single cell.
fn boxes() -> Vec<Vec<DVec2>> {
    let mut cases: Vec<Vec<DVec2>> = families(900, 5).into_iter().map(|(_, pslg)| pslg.points().to_vec()).collect();
    let tame = |bits: u64| f64::from_bits(if bits >> 52 & 0x7ff == 0x7ff { bits & !(1 << 62) } else { bits });
    for len in [1, 7, 8, 9, 255, 256, 257, 1000] {
        cases.push(wide(len as u64, 2 * len).chunks(2).map(|pair| DVec2::new(tame(pair[0]), tame(pair[1]))).collect());
    }
    // Boxes that are a power of two wide, less or more by an ulp, and off zero.
    for width in [2047.0, 2048.0, 2049.0, 1.0, 1.0_f64.next_up(), 1.0_f64.next_down()] {
        for low in [0.0, -0.3, 1e9, -5e-324, 0.5] {
            cases.push([0.0, 0.25, 0.7, 1.0].map(|x| DVec2::new(low + x * width, low - x)).to_vec());
        }
    }
    cases
}

#[test]
fn mark_cells() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<MarkCells>::new(&gpu.device, &[]).unwrap();
    for points in boxes() {
        let bounds = Bounds::of(&points).unwrap();
        let ordered = gpu.buffer(&bound_partials(&bound_points(&points, 1, 256)));
        for every in [1, 2, 4] {
            let (input, bits) = (gpu.buffer(&points), gpu.buffer(&vec![0_u32; SIDE * SIDE / 32]));
            let counts = gpu.buffer(&[7_u32; 4]);
            let arguments = MarkCellsArgs {
                points: input.view().cast(),
                bounds: ordered.view(),
                bits: bits.view(),
                counts: counts.view(),
                count: points.len() as u32,
                every,
            };
            let mut recording = gpu.recording();
            recording.dispatch(&kernel, groups_for(8 * points.len().div_ceil(8 * every as usize), 256), &arguments);
            gpu.run(&recording);
            let expected = reference::mark_cells(&points, &bounds, every);
            assert!(gpu.fetch(bits.view()) == expected, "{} points in {bounds:?}", points.len());
            assert_eq!(gpu.fetch(counts.view()), [0; 4]);
        }
    }
}

#[test]
fn count_cells() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<CountCells>::new(&gpu.device, &[]).unwrap();
    for (seed, every) in [(1, 0), (2, 1), (3, 100), (4, 3), (5, 1000)] {
        let mut list = vec![0_u32; SIDE * SIDE / 32];
        let scattered = words(seed, 2 * list.len().checked_div(every).unwrap_or(0));
        for pair in scattered.chunks(2) {
            list[pair[0] as usize % (SIDE * SIDE / 32)] |= 1 << (pair[1] % 32);
        }
        let (bits, counts) = (gpu.buffer(&list), gpu.buffer(&[0_u32; 4]));
        let mut recording = gpu.recording();
        recording.dispatch(&kernel, [32, 32, 1], &CountCellsArgs { bits: bits.view(), counts: counts.view() });
        gpu.run(&recording);
        assert_eq!(gpu.fetch(counts.view()), reference::count_cells(&list), "{seed}");
    }
}

#[test]
fn the_device_fits_the_grid_that_the_host_fits() {
    let mut gpu = Gpu::open();
    let (find, cells) = (FindBounds::new(&gpu.device).unwrap(), FindOccupancy::new(&gpu.device).unwrap());
    for (count, is_asked) in [(1000, false), (65_535, false), (65_536, true), (70_001, true)] {
        for pslg in [
            generate::uniform(count, 1),
            generate::thin_ring(count, 1e-3, 2),
            generate::clusters(count, 20, 1e-4, 3),
            generate::gaussian(count, 4),
            generate::noisy_line(count, 1e-6, 5),
        ] {
            let points = pslg.points();
            let input = gpu.buffer(points);
            let mut recording = gpu.recording();
            let read = find.record(&mut recording, input.view()).unwrap();
            let occupied = cells.record(&mut recording, input.view(), &find);
            let report = gpu.run(&recording);
            let bounds = read.bounds(&report).unwrap();
            let occupancy = occupied.occupancy(&report, &bounds);
            assert_eq!(occupancy.is_some(), is_asked);
            assert_eq!(occupancy, Occupancy::of(points, &bounds));
            let options = Options::default();
            let mapping = GridMapping::fit_bounds(&bounds, occupancy.as_ref(), count, &options).unwrap();
            assert_eq!(mapping, GridMapping::fit(points, &options).unwrap());
        }
    }
}
