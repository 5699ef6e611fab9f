//! Whole constrained triangulations on a Vulkan device against the CPU, by digest; asserted from the report that no stage ran
//! on the CPU.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod facade_gpu_support;
mod vulkan_support;

use facade_gpu_support::{assert_on_device, assert_same, close, on_cpu, on_device, open, sets, stage, twice};
use polder::{Backend, CrossingPolicy, DVec2, Error, Gpu, MeshError, Options, Pslg, Report, triangulate, verify};
use polder_flip::gpu::Arithmetic;
use polder_io::generate;
use polder_tests::constrained_families;
use polder_vulkan::{Device, Engine};

fn pslg(points: &[(f64, f64)], constraints: &[[u32; 2]]) -> Pslg {
    Pslg::new(points.iter().copied().map(DVec2::from).collect(), constraints.to_vec()).unwrap()
}

#[test]
fn every_family_has_the_digest_of_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    for (name, pslg) in constrained_families(1000, 71) {
        let report = assert_same(&mut gpu, name, &pslg, &Options::default());
        let counts = |name: &str| &stage(&report, name).counts;
        assert!(counts("walk")["pieces"] > 0, "{name}");
        assert!(name != "segments" || counts("constrain")["flips"] > 0, "{name}");
    }
    close(gpu);
}

#[test]
fn every_family_with_integers_alone() {
    let mut gpu = open(Arithmetic::Integers);
    for (name, pslg) in constrained_families(1000, 72) {
        assert_same(&mut gpu, name, &pslg, &Options::default());
    }
    close(gpu);
}

/// Points, constraints, and points again on the same memory.
#[test]
fn what_was_there_before_does_not_change_the_result() {
    let mut gpu = open(Arithmetic::Filtered);
    let (points, constraints) = generate::segments(1500, 200, 3).into_parts();
    let plain = Pslg::new(points.clone(), Vec::new()).unwrap();
    let with = Pslg::new(points.clone(), constraints.clone()).unwrap();
    let fewer = Pslg::new(points.clone(), constraints[..90].to_vec()).unwrap();
    let expected = triangulate(&plain, &on_cpu()).unwrap().triangulation;
    for grid in [None, Some(1), Some(17), Some(300)] {
        let options = Options { grid, ..Options::default() };
        let output = gpu.triangulate(&plain, &options).unwrap();
        assert!(output.triangulation == expected);
        assert!(output.report.stages.iter().all(|stage| !["walk", "constrain"].contains(&stage.name)));
        assert_same(&mut gpu, "fewer", &fewer, &options);
        assert_same(&mut gpu, "with", &with, &options);
    }
    let used = gpu.device().memory_use().used;
    let report = assert_same(&mut gpu, "again", &with, &Options { grid: Some(300), ..Options::default() });
    assert_eq!(gpu.device().memory_use().used, used, "a call of the same size allocates nothing");
    let waits = report.device.unwrap().host_waits;
    assert!(waits <= 10, "{waits}");

    let shuffled = polder_tests::shuffled(&with, 4);
    let output = gpu.triangulate(&shuffled.pslg, &Options::default()).unwrap();
    let expected = triangulate(&with, &on_cpu()).unwrap().triangulation;
    assert_eq!(shuffled.digest_back(&output.triangulation), expected.digest());
    close(gpu);
}

/// Not the result alone: what the stages count is told alike, points flipped first or not. Up to the constraints, whose
/// pieces a device numbers in another way.
#[test]
fn the_references_take_the_same_way() {
    let mut gpu = open(Arithmetic::Filtered);
    let points = generate::uniform(300, 3);
    let delaunay = triangulate(&points, &on_cpu()).unwrap().triangulation;
    let edges: Vec<[u32; 2]> = delaunay.edges().map(|edge| edge.vertices.map(|v| v.0)).collect();
    for constraints in [0, 40, 224, 225, 290] {
        let pslg = Pslg::new(points.points().to_vec(), edges[..constraints].to_vec()).unwrap();
        let found = gpu.triangulate(&pslg, &Options::default()).unwrap().report;
        let expected = triangulate(&pslg, &Options::with_backend(Backend::Reference)).unwrap().report;
        let names = |report: &Report| -> Vec<&str> { report.stages.iter().map(|stage| stage.name).collect() };
        let mut alike = vec!["voronoi", "shift", "insert"];
        alike.push(if constraints == 0 { "flip" } else { "flip_points" });
        for report in [&found, &expected] {
            assert_eq!(names(report).contains(&"flip_points"), constraints >= 225);
        }
        for name in alike.into_iter().filter(|name| names(&expected).contains(name)) {
            assert_eq!(stage(&found, name).counts, stage(&expected, name).counts, "{constraints} constraints, {name}");
        }
    }
    close(gpu);
}

#[test]
fn few_points() {
    let mut gpu = open(Arithmetic::Filtered);
    for (name, pslg) in [
        ("one point", pslg(&[(1.0, 2.0)], &[[0, 0], [0, 0]])),
        ("two points", pslg(&[(1.0, 2.0), (0.0, 3.0)], &[[1, 0], [0, 1], [1, 1]])),
        ("one point, again and again", pslg(&[(0.1, 0.2); 5], &[[3, 1], [2, 2]])),
        ("a triangle", pslg(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], &[[2, 1]])),
        ("a square", pslg(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[[3, 1]])),
        ("the other diagonal", pslg(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[[2, 0]])),
        (
            "duplicates as ends",
            pslg(
                &[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (2.0, 2.0), (-0.0, 0.0), (1.0, 1.0), (0.0, -0.0)],
                &[[4, 7], [5, 2], [0, 5], [6, 6], [3, 6], [7, 1]],
            ),
        ),
        (
            "through vertices, overlapping, turned",
            pslg(
                &[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (1.5, 5.0), (1.5, -5.0)],
                &[[0, 3], [3, 1], [1, 2], [0, 2], [4, 0], [5, 0]],
            ),
        ),
    ] {
        assert_same(&mut gpu, name, &pslg, &Options::default());
    }
    for count in [3, 4, 5, 7, 31, 33, 127, 257] {
        for seed in 0..if count < 10 { 8 } else { 1 } {
            let name = format!("{count} with segments, {seed}");
            assert_same(&mut gpu, &name, &generate::segments(count, count / 3, seed), &Options::default());
        }
    }
    close(gpu);
}

#[test]
fn points_on_a_line() {
    let mut gpu = open(Arithmetic::Filtered);
    for count in [2, 3, 100, 257, 2000] {
        let places = |i: usize| (i * 7919 % count) as f64 * 0.1;
        let lines: [Vec<DVec2>; 3] = [
            (0..count).map(|i| DVec2::new(places(i), -3.0)).collect(),
            (0..count).map(|i| DVec2::new(5.5, places(i))).collect(),
            (0..count).map(|i| DVec2::splat(places(i / 2))).collect(),
        ];
        for points in lines {
            let ends = |i: usize| [i * 31 % count, i * i * 17 % count].map(|i| i as u32);
            let pslg = Pslg::new(points, (0..40).map(ends).collect()).unwrap();
            let report = assert_same(&mut gpu, &format!("{count} on a line"), &pslg, &Options::default());
            assert_eq!(report.triangles, 0);
        }
    }
    // The memory of a line is not lent to a triangulation.
    assert_same(&mut gpu, "no line", &generate::segments(2000, 40, 1), &Options::default());
    close(gpu);
}

/// One constraint through more vertices than there is room for at first.
#[test]
fn constraints_through_very_many_vertices() {
    let mut gpu = open(Arithmetic::Filtered);
    let side = 140;
    let (points, _) = generate::lattice(side, side).into_parts();
    // Each of the rows runs through all vertices of it: more than two a constraint and those of the start together.
    let row = |y: u32| [y * side as u32, (y + 1) * side as u32 - 1];
    let constraints: Vec<[u32; 2]> = (0..6 * side as u32).map(|i| row(i % side as u32)).collect();
    let pslg = Pslg::new(points, constraints).unwrap();
    assert!(6 * side * (side - 2) > 2 * 6 * side + (1 << 16));
    assert_same(&mut gpu, "rows", &pslg, &Options::default());
    assert_same(&mut gpu, "rows again", &pslg, &Options::default());
    close(gpu);
}

#[test]
fn real_sets() {
    let mut gpu = open(Arithmetic::Filtered);
    for (name, pslg) in &sets() {
        let report = assert_same(&mut gpu, name, pslg, &Options::default());
        assert!(report.constraints.constrained_edges > 0, "{name}");
        let output = gpu.triangulate(pslg, &Options::default()).unwrap();
        assert!(verify::check_triangulation(pslg, &output.triangulation).is_canonical(), "{name}");
    }
    close(gpu);
}

#[test]
fn constraints_and_result_may_stay_on_the_device() {
    let device = Device::open(&vulkan_support::options()).unwrap();
    let mut own = Engine::new(&device).unwrap();
    let mut gpu = Gpu::on(&device).unwrap();
    for (name, pslg) in constrained_families(400, 9) {
        let expected = triangulate(&pslg, &on_cpu()).unwrap();
        let (points, constraints) = on_device(&device, &mut own, &pslg);
        let made = gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &Options::default());
        let mut result = made.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(result.report().stages_on_cpu().count(), 0);
        let (told, wanted) = (&result.report().constraints, &expected.report.constraints);
        assert_eq!(told.total, wanted.total, "{name}");
        assert_eq!(told.through_vertices, wanted.through_vertices, "{name}");
        assert_eq!(told.constrained_edges, wanted.constrained_edges, "{name}");
        let (expected, report) = (expected.triangulation, expected.report);
        assert_eq!(own.download_vec(result.triangles().unwrap().unwrap()).unwrap(), expected.triangles(), "{name}");
        let bits = own.download_vec(result.constrained().unwrap().unwrap()).unwrap();
        assert_eq!(bits, expected.constrained_bits(), "{name}");
        let chains = result.chains().unwrap().unwrap();
        assert_eq!(own.download_vec(chains.offsets).unwrap(), expected.chains().offsets(), "{name}");
        assert_eq!(own.download_vec(chains.vertices).unwrap(), expected.chains().vertices(), "{name}");
        assert!(result.fetch().unwrap() == expected, "{name}");
        assert_eq!(result.report().constraints, report.constraints, "{name}");
    }
    let pslg = generate::crossing_segments(90, 30, 1.0, 2);
    let (points, constraints) = on_device(&device, &mut own, &pslg);
    let all = (points.view(), constraints.view());

    // No constraints are as if none were given; indices are looked at before any work.
    let (none, few) = (constraints.slice(0..0).unwrap(), points.slice(0..0).unwrap());
    let result = gpu.triangulate_constrained_on_device(all.0, none, &Options::default()).unwrap();
    assert!(result.chains().unwrap().is_none() && result.triangle_count() > 0);
    for (points, first) in [(few, 0), (points.slice(0..60).unwrap(), 0)] {
        let mut bad = vec![[0, 1]; pslg.constraints().len()];
        bad[17] = [3, 60];
        bad[23] = [u32::MAX, 3];
        own.upload(constraints.view(), &bad).unwrap();
        let error = gpu.triangulate_constrained_on_device(points, all.1, &Options::default()).unwrap_err();
        let (constraint, index) = if points.is_empty() { (first, 0) } else { (17, 60) };
        let points = points.len();
        assert_eq!(error, Error::Input(MeshError::IndexOutOfRange { constraint, index, points }));
    }
    drop(own);
    close(gpu);
}

#[test]
fn by_the_facade() {
    let segments = generate::segments(200, 40, 1);
    let selection = polder_vulkan::Selection::Environment;
    let vulkan = Options { device: selection.clone(), ..Options::with_backend(Backend::Vulkan) };
    let expected = triangulate(&segments, &on_cpu()).unwrap().triangulation;
    let output = triangulate(&segments, &vulkan).unwrap();
    assert!(output.triangulation == expected);
    assert_on_device(&output.report, "vulkan");
    let report = triangulate(&segments, &Options::default()).unwrap().report;
    assert_eq!(report.backend, "cpu");
    assert!(report.why.contains("200 points and 40 constraints; beside"), "{}", report.why);
    let crossing = generate::crossing_segments(90, 30, 1.0, 2);
    assert_eq!(triangulate(&crossing, &vulkan).unwrap_err(), triangulate(&crossing, &on_cpu()).unwrap_err());
    let split = CrossingPolicy::Split;
    let by = |options: Options| triangulate(&crossing, &Options { crossings: split, ..options }).unwrap().triangulation;
    assert!(by(vulkan) == by(on_cpu()));
}

/// Takes minutes on a large GPU with many cores beside it; `POLDER_POINTS` says how many points, `POLDER_FAMILY` which ones.
#[test]
#[ignore = "long"]
fn every_large_family_has_the_digest_of_the_cpu() {
    let points = std::env::var("POLDER_POINTS").map_or(1_000_000, |text| text.parse().unwrap());
    let wanted = std::env::var("POLDER_FAMILY").ok();
    let mut gpu = open(Arithmetic::Filtered);
    let mut failed = Vec::new();
    for (name, pslg) in constrained_families(points, 1) {
        if wanted.as_ref().is_none_or(|wanted| wanted == name) && twice(&mut gpu, name, &pslg).is_none() {
            failed.push(name);
        }
    }
    assert_eq!(failed, Vec::<&str>::new());
    close(gpu);
}

/// Uniform points and a tenth as many constraints of all lengths; and all of examples/data. `POLDER_DATA` is another folder
/// of inputs.
#[test]
#[ignore = "long"]
fn large_recipes_and_all_real_sets_have_the_digest_of_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    let mut failed = Vec::new();
    for (name, pslg) in sets() {
        failed.extend(twice(&mut gpu, &name, &pslg).is_none().then_some(name));
    }
    let most = std::env::var("POLDER_POINTS").map_or(10_000_000, |text| text.parse().unwrap());
    for points in [1_000_000, 10_000_000].into_iter().filter(|&points| points <= most) {
        let name = format!("{points} points, {} constraints", points / 10);
        let pslg = generate::segments(points, points / 10, 1);
        failed.extend(twice(&mut gpu, &name, &pslg).is_none().then_some(name));
    }
    assert_eq!(failed, Vec::<String>::new());
    close(gpu);
}
