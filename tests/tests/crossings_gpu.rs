//! Constraints that cross, on a Vulkan device against the CPU: named, or cut, from the host's memory and from the device's.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod facade_gpu_support;
mod vulkan_support;

use facade_gpu_support::{assert_same, close, on_cpu, on_device, open, stage};
use polder::{ConstraintId, CrossingPolicy, DVec2, Error, Gpu, Options, Place, Pslg, Report, triangulate, verify};
use polder_flip::gpu::Arithmetic;
use polder_io::generate;
use polder_vulkan::{Device, Engine};

fn splitting() -> Options {
    Options { crossings: CrossingPolicy::Split, ..on_cpu() }
}

fn square() -> Pslg {
    let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
    Pslg::new(points.to_vec(), vec![[0, 2], [0, 1], [3, 1], [2, 0]]).unwrap()
}

/// Lines of which each is a last place or two above or below the next one.
fn bundle() -> Pslg {
    let line = |i: u32| {
        let [from, to] = [i * 5 % 7, i * 3 % 7].map(|k| 1.0 + f64::from(k) * f64::EPSILON);
        [DVec2::new(1.0, from), DVec2::new(2.0, to)]
    };
    Pslg::new((0..4).flat_map(line).collect(), (0..4).map(|i| [2 * i, 2 * i + 1]).collect()).unwrap()
}

fn cases() -> Vec<Pslg> {
    vec![
        square(),
        bundle(),
        generate::crossing_segments(300, 100, 1.0, 1),
        generate::crossing_segments(900, 300, 0.1, 2),
        generate::crossing_segments(60, 20, 0.5, 3),
    ]
}

#[test]
fn crossings_are_named_as_on_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    for pslg in &cases() {
        for max_crossings in [1_000_000, 7, 1, 0] {
            let options = Options { max_crossings, ..on_cpu() };
            let expected = triangulate(pslg, &options).unwrap_err();
            assert!(matches!(expected, Error::CrossingConstraints { .. }));
            assert_eq!(gpu.triangulate(pslg, &options).unwrap_err(), expected);
            let mut own = Engine::new(gpu.device()).unwrap();
            let (points, constraints) = on_device(gpu.device(), &mut own, pslg);
            let named = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &options);
            assert_eq!(named.unwrap_err(), expected);
        }
        // What crosses leaves nothing behind.
        assert_same(&mut gpu, "after crossings", &generate::segments(300, 100, 1), &Options::default());
    }
    close(gpu);
}

/// Cutting is the host's work, and said so; all else is the device's.
fn assert_cut_on_host(report: &Report, fetched: bool) {
    let stages: Vec<(&str, Place)> = report.stages.iter().map(|stage| (stage.name, stage.on)).collect();
    let mut first = vec![("crossings_met", Place::Device)];
    first.extend(fetched.then_some(("fetch", Place::Transfer)));
    first.extend([("split", Place::Cpu), ("upload", Place::Transfer), ("bounds", Place::Device)]);
    assert!(stages.starts_with(&first), "{stages:?}");
    assert_eq!(report.stages_on_cpu().count(), 1, "{stages:?}");
    assert_eq!(stage(report, "split").counts["added_vertices"], report.points.added as u64);
}

#[test]
fn crossings_are_split_as_on_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    for pslg in &cases() {
        let expected = triangulate(pslg, &splitting()).unwrap();
        let output = gpu.triangulate(pslg, &splitting()).unwrap();
        assert_eq!(output.triangulation.digest(), expected.triangulation.digest());
        assert!(output.triangulation == expected.triangulation && !output.triangulation.added().is_empty());
        let (found, wanted) = (&output.report, &expected.report);
        assert_eq!((&found.points, &found.constraints), (&wanted.points, &wanted.constraints));
        assert_cut_on_host(found, false);
        assert_eq!(found.stages.last().map(|stage| stage.name), Some("download"));
    }
    // What does not cross is not cut.
    assert_same(&mut gpu, "segments", &generate::segments(300, 100, 1), &splitting());
    let pslg = generate::crossing_segments(300, 100, 0.3, 1);
    let limited = Options { max_added_vertices: 3, ..splitting() };
    assert_eq!(gpu.triangulate(&pslg, &limited).unwrap_err(), triangulate(&pslg, &limited).unwrap_err());
    close(gpu);
}

#[test]
fn crossings_on_the_device_are_split_and_the_result_stays_there() {
    let mut gpu = Gpu::on(&Device::open(&vulkan_support::options()).unwrap()).unwrap();
    let mut own = Engine::new(gpu.device()).unwrap();
    for pslg in &cases() {
        let expected = triangulate(pslg, &splitting()).unwrap();
        let (triangulation, wanted) = (expected.triangulation, expected.report);
        let (points, constraints) = on_device(gpu.device(), &mut own, pslg);
        for _ in 0..2 {
            let made = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &splitting());
            let mut result = made.unwrap();
            assert_cut_on_host(result.report(), true);
            let told = result.report();
            assert_eq!((&told.points, told.triangles), (&wanted.points, wanted.triangles));
            assert_eq!(told.constraints.total, wanted.constraints.total);
            assert_eq!(told.constraints.through_vertices, wanted.constraints.through_vertices);
            assert_eq!(told.constraints.constrained_edges, wanted.constraints.constrained_edges);

            assert_eq!(own.download_vec(result.triangles().unwrap().unwrap()).unwrap(), triangulation.triangles());
            let bits = own.download_vec(result.constrained().unwrap().unwrap()).unwrap();
            assert_eq!(bits, triangulation.constrained_bits());
            let chains = result.chains().unwrap().unwrap();
            assert_eq!(own.download_vec(chains.offsets).unwrap(), triangulation.chains().offsets());
            assert_eq!(own.download_vec(chains.vertices).unwrap(), triangulation.chains().vertices());
            let representatives = own.download_vec(result.representatives().unwrap()).unwrap();
            assert_eq!(representatives, triangulation.representatives());
            assert_eq!(result.added(), triangulation.added());
            let all = own.download_vec(result.cut_points().unwrap()).unwrap();
            let added = result.added().iter().map(|vertex| vertex.position);
            assert_eq!(all, pslg.points().iter().copied().chain(added).collect::<Vec<_>>());

            let fetched = result.fetch().unwrap();
            assert_eq!(fetched.digest(), triangulation.digest());
            assert!(fetched == triangulation);
            assert_eq!(result.report().constraints, wanted.constraints);
            // In the memory of another one, added vertices and all.
            let mut kept = fetched.clone();
            result.fetch_into(&mut kept).unwrap();
            assert!(kept == triangulation);
        }
    }
    let (points, constraints) = on_device(gpu.device(), &mut own, &square());
    let result = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &splitting()).unwrap();
    assert_eq!(result.added()[0].parents, [0, 2, 3].map(ConstraintId));
    assert_eq!(result.added()[0].position, DVec2::splat(0.5));

    // What does not cross is neither fetched nor cut, and nothing is left of what was.
    let segments = generate::segments(300, 100, 1);
    let (points, constraints) = on_device(gpu.device(), &mut own, &segments);
    let mut result = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &splitting()).unwrap();
    assert!(result.added().is_empty() && result.cut_points().is_none());
    assert_eq!(result.report().stages_on_cpu().count(), 0);
    let fetched = result.fetch().unwrap();
    assert!(fetched == triangulate(&segments, &on_cpu()).unwrap().triangulation);
    assert!(verify::check_triangulation(&segments, &fetched).is_canonical());

    // Where cutting is refused the error is the CPU's.
    let pslg = generate::crossing_segments(300, 100, 0.3, 1);
    let limited = Options { max_added_vertices: 3, ..splitting() };
    let (points, constraints) = on_device(gpu.device(), &mut own, &pslg);
    let refused = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &limited);
    assert_eq!(refused.unwrap_err(), triangulate(&pslg, &limited).unwrap_err());
    drop(own);
    close(gpu);
}
