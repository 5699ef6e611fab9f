//! Whole triangulations on a Vulkan device against the CPU, by digest; asserted from the report that no stage ran on the CPU.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod facade_gpu_support;
mod vulkan_support;

use facade_gpu_support::{assert_on_device, assert_same, close, on_cpu, open, twice};
use polder::{AUTO_FROM, Backend, DVec2, Error, Gpu, MeshError, Options, Pslg, Report, triangulate, verify};
use polder_flip::gpu::Arithmetic;
use polder_io::generate;
use polder_tests::{families, point_families};
use polder_vulkan::{Buffer, Device, DeviceKind, Engine, Selection};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn without_constraints(pslg: &Pslg) -> Pslg {
    Pslg::new(pslg.points().to_vec(), Vec::new()).unwrap()
}

/// Waits for the host of one triangulation, whatever the points are.
const MOST_WAITS: u32 = 10;

#[test]
fn every_family_has_the_digest_of_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    for (name, pslg) in families(1000, 61) {
        assert_same(&mut gpu, name, &without_constraints(&pslg), &Options::default());
    }
    close(gpu);
}

#[test]
fn every_family_with_integers_alone() {
    let mut gpu = open(Arithmetic::Integers);
    for (name, pslg) in point_families(300, 62) {
        assert_same(&mut gpu, name, &pslg, &Options::default());
    }
    close(gpu);
}

#[test]
fn few_points_and_numbers_around_a_workgroup() {
    let mut gpu = open(Arithmetic::Filtered);
    for count in [1, 2, 3, 4, 5, 7, 31, 32, 33, 127, 129, 255, 256, 257, 1023, 4097] {
        for seed in 0..if count < 10 { 8 } else { 1 } {
            let pslg = generate::uniform(count, 100 * count as u64 + seed);
            assert_same(&mut gpu, &format!("{count} uniform, {seed}"), &pslg, &Options::default());
        }
    }
    for (name, points) in [
        ("no point", vec![]),
        ("one point", vec![(1.0, 2.0)]),
        ("two", vec![(1.0, 2.0), (-3.0, 4.0)]),
        ("one point, seven times", vec![(0.1, 0.2); 7]),
        ("two points, again and again", [(0.0, -0.0), (1.0, 1.0), (-0.0, 0.0)].repeat(5)),
        ("on a line", (0..5).map(|i| (0.1 * f64::from(i), 0.1 * f64::from(i))).collect()),
        ("a square", vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),
    ] {
        let pslg = Pslg::new(points.into_iter().map(DVec2::from).collect(), Vec::new()).unwrap();
        let output = gpu.triangulate(&pslg, &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected = triangulate(&pslg, &on_cpu()).unwrap();
        assert!(output.triangulation == expected.triangulation, "{name}");
        assert_eq!(output.report.stages_on_cpu().count(), 0, "{name}");
        assert!(verify::check_triangulation(&pslg, &output.triangulation).is_canonical());
    }
    close(gpu);
}

#[test]
fn neither_grid_nor_order_nor_what_was_there_before_change_the_result() {
    let mut gpu = open(Arithmetic::Filtered);
    let pslg = generate::clusters(1500, 5, 1e-3, 3);
    for grid in [None, Some(1), Some(2), Some(17), Some(300), None] {
        let options = Options { grid, ..Options::default() };
        assert_same(&mut gpu, &format!("grid {grid:?}"), &pslg, &options);
    }
    let shuffled = polder_tests::shuffled(&pslg, 4);
    let output = gpu.triangulate(&shuffled.pslg, &Options::default()).unwrap();
    let expected = triangulate(&pslg, &on_cpu()).unwrap().triangulation;
    assert_eq!(shuffled.digest_back(&output.triangulation), expected.digest());
    close(gpu);
}

#[test]
fn a_second_call_of_the_same_size_allocates_nothing() {
    let mut gpu = open(Arithmetic::Filtered);
    let pslg = generate::uniform(2000, 9);
    let first = assert_same(&mut gpu, "first", &pslg, &Options::default());
    let used = gpu.device().memory_use().used;
    let second = assert_same(&mut gpu, "second", &pslg, &Options::default());
    assert_eq!(gpu.device().memory_use().used, used);
    let waits = |report: &Report| report.device.as_ref().unwrap().host_waits;
    assert!(waits(&first) <= 10 && waits(&second) <= 10, "{} {}", waits(&first), waits(&second));
    gpu.release();
    // Staging memory is kept.
    assert!(gpu.device().memory_use().used + 150 * 2000 < used);
    assert_same(&mut gpu, "third", &pslg, &Options::default());
    close(gpu);
}

#[test]
fn memory_that_is_made_while_the_device_works_holds_the_result() {
    let mut gpu = open(Arithmetic::Filtered);
    let uniform = generate::uniform(110_000, 3);
    let (some, none) = (generate::uniform(1000, 3), Pslg::new(vec![[1.0, 2.0].into(); 100_000], vec![]).unwrap());
    let repeated = Pslg::new(some.points().repeat(100), vec![]).unwrap();
    for pslg in [uniform, repeated, none] {
        assert_same(&mut gpu, "many points", &pslg, &Options::default());
    }
    close(gpu);
}

#[test]
fn points_and_result_may_stay_on_the_device() {
    let device = Device::open(&vulkan_support::options()).unwrap();
    let pslg = generate::gaussian(3000, 2);
    let expected = triangulate(&pslg, &on_cpu()).unwrap().triangulation;
    let mut own = Engine::new(&device).unwrap();
    let points = Buffer::new(&device, "points", 3000).unwrap();
    own.upload(points.view(), pslg.points()).unwrap();
    let mut gpu = Gpu::on(&device).unwrap();
    let mut result = gpu.triangulate_on_device(points.view(), &Options::default()).unwrap();
    assert_eq!(result.report().stages_on_cpu().count(), 0);
    assert_eq!(result.triangle_count(), expected.triangles().len());
    assert_eq!(own.download_vec(result.triangles().unwrap().unwrap()).unwrap(), expected.triangles());
    assert_eq!(own.download_vec(result.neighbors().unwrap().unwrap()).unwrap(), expected.neighbors());
    assert_eq!(own.download_vec(result.representatives().unwrap()).unwrap(), expected.representatives());
    assert!(result.fetch().unwrap() == expected);
    let mut kept = expected.clone();
    let place = kept.triangles().as_ptr();
    result.fetch_into(&mut kept).unwrap();
    assert!(kept == expected && kept.triangles().as_ptr() == place);

    let mut bad = pslg.points().to_vec();
    bad[1234].y = f64::NAN;
    own.upload(points.view(), &bad).unwrap();
    let error = gpu.triangulate_on_device(points.view(), &Options::default()).unwrap_err();
    assert_eq!(error, Error::Input(MeshError::NonFiniteCoordinate { point: 1234, axis: 'y' }));
    own.upload(points.view(), pslg.points()).unwrap();
    assert!(gpu.triangulate_on_device(points.view(), &Options::default()).unwrap().fetch().unwrap() == expected);
    close(gpu);
}

#[test]
fn what_cannot_be_done_is_a_typed_error_and_auto_goes_to_the_cpu() {
    let points = generate::uniform(100, 1);
    let selection = Selection::Environment;
    let vulkan = Options { device: selection.clone(), ..Options::with_backend(Backend::Vulkan) };
    let nothing = Selection::Name("no such device".into());
    let error = triangulate(&points, &Options { device: nothing.clone(), ..vulkan.clone() }).unwrap_err();
    assert!(error.kind() == "unsupported" && error.to_string().contains("no such device"), "{error}");
    let error = triangulate(&points, &Options { grid: Some(0), ..vulkan.clone() }).unwrap_err();
    assert_eq!(error.kind(), "unsupported");
    let cancel = Some(Arc::new(AtomicBool::new(true)));
    assert_eq!(triangulate(&points, &Options { cancel, ..vulkan.clone() }).unwrap_err().kind(), "cancelled");

    let report = triangulate(&points, &vulkan).unwrap().report;
    assert_on_device(&report, "vulkan");
    assert!(report.device.unwrap().opening_seconds.is_some_and(|opening| opening > 0.0 && opening < report.seconds));
    let report = triangulate(&points, &Options::default()).unwrap().report;
    assert_eq!(report.backend, "cpu");
    assert!(report.why.contains("a GPU pays from"), "{}", report.why);
    assert_eq!(report.stages_on_cpu().count(), report.stages.len());
    // Enough points, few threads.
    let many = Pslg::new(points.points().repeat(AUTO_FROM / 200), vec![]).unwrap();
    let few = |device: &Selection| Options { threads: 2, device: device.clone(), ..Options::default() };
    let report = triangulate(&many, &few(&nothing)).unwrap().report;
    assert!(report.backend == "cpu" && report.why.contains("no such device"), "{}", report.why);
    let report = triangulate(&many, &few(&selection)).unwrap().report;
    let is_cpu = Device::open(&vulkan_support::options()).unwrap().info().kind == DeviceKind::Cpu;
    let (backend, why) =
        if is_cpu { ("cpu", "is a CPU") } else { ("vulkan", "beside 2 threads it pays from 500000 points on") };
    assert!(report.backend == backend && report.why.contains(why), "{}", report.why);
    let fewer = Pslg::new(many.points()[1..].to_vec(), vec![]).unwrap();
    let report = triangulate(&fewer, &few(&selection)).unwrap().report;
    assert!(
        report.backend == "cpu" && report.why.contains("beside 2 threads a GPU pays from 500000 points on"),
        "{}",
        report.why
    );
}

#[test]
fn loss_and_lack_of_memory_are_errors_and_the_next_call_works() {
    let pslg = generate::uniform(500, 5);
    let expected = triangulate(&pslg, &on_cpu()).unwrap().triangulation;
    let mut gpu = open(Arithmetic::Filtered);
    for allocation in 0..200 {
        gpu.release();
        gpu.device().faults().refuse_allocation(allocation);
        match gpu.triangulate(&pslg, &Options::default()) {
            Err(Error::OutOfMemory { .. }) => {}
            Ok(output) => {
                assert!(output.triangulation == expected && allocation > 10);
                break;
            }
            Err(other) => panic!("{other}"),
        }
        assert!(gpu.triangulate(&pslg, &Options::default()).unwrap().triangulation == expected);
    }
    close(gpu);
}

/// Takes a minute on a large GPU with many cores beside it; `POLDER_POINTS` says how many points, `POLDER_FAMILY` which ones.
#[test]
#[ignore = "long"]
fn every_large_family_has_the_digest_of_the_cpu() {
    let points = std::env::var("POLDER_POINTS").map_or(1_000_000, |text| text.parse().unwrap());
    let wanted = std::env::var("POLDER_FAMILY").ok();
    let mut gpu = open(Arithmetic::Filtered);
    let mut failed = Vec::new();
    for (name, pslg) in point_families(points, 1) {
        if wanted.as_ref().is_some_and(|wanted| wanted != name) {
            continue;
        }
        let same = twice(&mut gpu, name, &pslg).is_some_and(|reports| {
            let waits = reports.iter().map(|report| report.device.as_ref().unwrap().host_waits);
            waits.max() <= Some(MOST_WAITS)
        });
        failed.extend((!same).then_some(name));
    }
    assert_eq!(failed, Vec::<&str>::new());
    close(gpu);
}
