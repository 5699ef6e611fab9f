//! The bounding box of points on the device, and the grid that it gives: the host's, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_tests::families;
use polder_voronoi::gpu::FindBounds;
use polder_voronoi::kernels::{BoundPartials, BoundPartialsArgs, BoundPoints, BoundPointsArgs};
use polder_voronoi::{Bounds, DVec2, GridMapping, Options, Resolution, VoronoiError, reference};
use polder_vulkan::{Buffer, Kernel};
use vulkan_support::{Gpu, wide};

const LENGTHS: [usize; 14] = [0, 1, 2, 3, 255, 256, 257, 1023, 1024, 1025, 4097, 70_001, 262_144, 300_007];

/// Numbers of any bits: all magnitudes, NaN, infinities.
fn any_bits(seed: u64, len: usize) -> Vec<DVec2> {
    wide(seed, 2 * len).chunks(2).map(|pair| DVec2::new(f64::from_bits(pair[0]), f64::from_bits(pair[1]))).collect()
}

/// The same with every coordinate made finite.
fn finite(seed: u64, len: usize) -> Vec<DVec2> {
    let tame = |x: f64| if x.is_finite() { x } else { f64::from_bits(x.to_bits() & !(1 << 62)) };
    any_bits(seed, len).into_iter().map(|p| DVec2::new(tame(p.x), tame(p.y))).collect()
}

fn special() -> Vec<Vec<DVec2>> {
    let (zero, ulp) = (0.0_f64, 5e-324);
    let pairs: [&[[f64; 2]]; 8] = [
        &[[-zero, zero], [zero, -zero]],
        &[[-zero, -zero]],
        &[[-ulp, ulp], [zero, -zero]],
        &[[f64::MAX, f64::MIN], [f64::MIN, f64::MAX]],
        &[[f64::MIN_POSITIVE, -f64::MIN_POSITIVE]; 3],
        &[[1.0, 2.0], [1.0, f64::NAN], [f64::INFINITY, f64::NAN]],
        &[[1.0, 2.0], [-f64::NAN, 3.0], [1.0, f64::NAN]],
        &[[1.0, f64::NEG_INFINITY]],
    ];
    pairs.into_iter().map(|list| list.iter().map(|&p| DVec2::from(p)).collect()).collect()
}

#[test]
fn bound_points() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<BoundPoints>::new(&gpu.device, &[]).unwrap();
    let mut cases = special();
    cases.extend(LENGTHS.iter().flat_map(|&len| [any_bits(len as u64, len), finite(len as u64 + 1, len)]));
    for points in cases {
        for groups in [1, 2, 7, 64] {
            let (input, partial) = (gpu.buffer(&points), gpu.buffer(&vec![7_u64; 5 * groups]));
            let arguments = BoundPointsArgs {
                points: input.view().cast::<[u32; 4]>(),
                partial: partial.view(),
                count: points.len() as u32,
            };
            let mut recording = gpu.recording();
            recording.dispatch(&kernel, [groups as u32, 1, 1], &arguments);
            gpu.run(&recording);
            let expected = reference::bound_points(&points, groups, 256);
            assert_eq!(gpu.fetch(partial.view()), expected.concat(), "{} points, {groups} groups", points.len());
        }
    }
}

#[test]
fn bound_partials() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<BoundPartials>::new(&gpu.device, &[]).unwrap();
    for groups in [0, 1, 2, 3, 255, 256, 257, 1024] {
        let list = wide(groups as u64 + 5, 5 * groups);
        let (partial, bounds) = (gpu.buffer(&list), gpu.buffer(&[7_u64; 5]));
        let arguments = BoundPartialsArgs { partial: partial.view(), bounds: bounds.view(), count: groups as u32 };
        let mut recording = gpu.recording();
        recording.dispatch(&kernel, [1, 1, 1], &arguments);
        gpu.run(&recording);
        let fives: Vec<[u64; 5]> = list.chunks(5).map(|five| five.try_into().unwrap()).collect();
        assert_eq!(gpu.fetch(bounds.view()), reference::bound_partials(&fives), "{groups}");
    }
}

fn found(gpu: &mut Gpu, find: &FindBounds, points: &[DVec2]) -> Result<Bounds, VoronoiError> {
    let input: Buffer<DVec2> = gpu.buffer(points);
    let mut recording = gpu.recording();
    let read = find.record(&mut recording, input.view()).unwrap();
    let report = gpu.run(&recording);
    assert_eq!((report.waits, report.dispatches), (1, 2));
    read.bounds(&report)
}

#[test]
fn the_device_fits_the_grid_that_the_host_fits() {
    let mut gpu = Gpu::open();
    let find = FindBounds::new(&gpu.device).unwrap();
    let mut cases: Vec<Vec<DVec2>> =
        families(3000, 77).into_iter().map(|(_, pslg)| pslg.points().to_vec()).chain(special()).collect();
    cases.extend(LENGTHS.iter().map(|&len| finite(len as u64 + 9, len)));
    let mut refused = 0;
    for points in cases {
        let box_on_device = found(&mut gpu, &find, &points);
        match (Bounds::of(&points), &box_on_device) {
            (Ok(expected), Ok(found)) => {
                let bits = |b: &Bounds| [b.low(), b.high()].map(|p| p.to_array().map(f64::to_bits));
                assert_eq!(bits(&expected), bits(found));
            }
            (expected, found) => assert_eq!(&expected, found),
        }
        let plain = Resolution::PixelsPerPoint(7.0);
        for options in [plain, Resolution::LongerSide(300), Resolution::LongerSide(0)].map(Options::from) {
            let fit = box_on_device.clone().and_then(|b| GridMapping::fit_bounds(&b, None, points.len(), &options));
            assert_eq!(fit, GridMapping::fit(&points, &options));
            refused += usize::from(fit.is_err());
        }
    }
    assert!(refused > 15, "{refused}");
}

#[test]
fn the_first_coordinate_that_is_not_finite_is_named() {
    let mut gpu = Gpu::open();
    let find = FindBounds::new(&gpu.device).unwrap();
    for (seed, len) in LENGTHS.into_iter().enumerate().skip(1) {
        for (turn, bad) in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY].into_iter().enumerate() {
            let mut points = finite(seed as u64 + 40, len);
            let at = words_below(seed as u64 * 4 + turn as u64, len);
            let axis = usize::from(turn % 2 == 1);
            points[at][axis] = bad;
            // Later ones, and the other coordinate, do not count.
            points[len - 1].y = if at == len - 1 && axis == 0 { points[at].y } else { bad };
            let expected = VoronoiError::NonFiniteCoordinate { point: at, axis: ['x', 'y'][axis] };
            assert_eq!(found(&mut gpu, &find, &points), Err(expected));
        }
    }
}

fn words_below(seed: u64, len: usize) -> usize {
    vulkan_support::words(seed, 1)[0] as usize % len
}
