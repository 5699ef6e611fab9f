//! Whole triangulations on a device, held against the CPU's.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use crate::vulkan_support;
use polder::{Backend, DVec2, Gpu, Options, Place, Pslg, Report, StageReport, triangulate};
use polder_flip::gpu::Arithmetic;
use polder_vulkan::{Buffer, Device, Engine};

pub(crate) fn open(arithmetic: Arithmetic) -> Gpu {
    let device = Device::open(&vulkan_support::options()).unwrap();
    Gpu::with_arithmetic(&device, arithmetic).unwrap()
}

/// The validation layer must have had nothing to say, and no kernel have written past an end.
pub(crate) fn close(gpu: Gpu) {
    assert_eq!(gpu.device().validation_messages(), Vec::<String>::new());
    assert_eq!(gpu.device().overruns(), Vec::<String>::new());
}

pub(crate) fn on_cpu() -> Options {
    Options::with_backend(Backend::Cpu)
}

/// All stages ran, in order, and none on the CPU.
pub(crate) fn assert_on_device(report: &Report, name: &str) {
    assert_eq!(report.backend, "vulkan", "{name}");
    assert_eq!(report.stages_on_cpu().count(), 0, "{name}");
    let device = report.device.as_ref().unwrap();
    assert!(!device.name.is_empty() && device.dispatches > 0 && device.peak_bytes > 0, "{name}");
    let mut expected = vec!["upload", "bounds", "voronoi", "dualize", "shift", "insert"];
    let (points, constraints) = (report.points.total, report.constraints.total);
    if 4 * constraints >= 3 * points {
        expected.push("flip_points");
    }
    if constraints > 0 {
        expected.extend(["walk", "constrain"]);
    }
    expected.extend(["flip", "canonical_order", "download"]);
    let stages: Vec<&str> = report.stages.iter().map(|stage| stage.name).collect();
    assert_eq!(stages, expected, "{name}");
    for stage in &report.stages {
        let moved = matches!(stage.name, "upload" | "download");
        assert_eq!(stage.on, if moved { Place::Transfer } else { Place::Device }, "{name}, {}", stage.name);
    }
}

/// The device gives what the CPU gives, all of it.
pub(crate) fn assert_same(gpu: &mut Gpu, name: &str, pslg: &Pslg, options: &Options) -> Report {
    let output = gpu.triangulate(pslg, options).unwrap_or_else(|error| panic!("{name}: {error}"));
    let expected = triangulate(pslg, &on_cpu()).unwrap();
    polder_tests::assert_same_output(name, &output, &expected);
    assert_on_device(&output.report, name);
    output.report
}

/// A large input twice, the second time on the memory of the first, as a card that has worked; prints what the device took then.
/// The reports, if both results are the CPU's.
pub(crate) fn twice(gpu: &mut Gpu, name: &str, pslg: &Pslg) -> Option<[Report; 2]> {
    let expected = triangulate(pslg, &on_cpu()).unwrap();
    gpu.release();
    let mut one = || {
        let output =
            gpu.triangulate(pslg, &Options::default()).inspect_err(|error| println!("{name}: {error}")).ok()?;
        assert_on_device(&output.report, name);
        let same = output.triangulation.digest() == expected.triangulation.digest()
            && output.triangulation == expected.triangulation
            && output.report.constraints == expected.report.constraints;
        same.then_some(output.report)
    };
    let reports = [one()?, one()?];
    let report = &reports[1];
    let device = report.device.as_ref().unwrap();
    let (waits, bytes) = (device.host_waits, device.peak_bytes / pslg.points().len() as u64);
    let stages: Vec<&StageReport> = report.stages.iter().filter(|stage| stage.on == Place::Device).collect();
    let all: f64 = stages.iter().map(|stage| 1e3 * stage.seconds).sum();
    let digest = expected.triangulation.digest();
    println!(
        "{name}: {digest}, {waits} waits, {bytes} bytes a point at the highest peak so far, {all:.2} ms on the device:"
    );
    for stage in stages {
        println!("  {} {:.2} ms, {:?}", stage.name, 1e3 * stage.seconds, stage.counts);
    }
    Some(reports)
}

pub(crate) fn stage<'a>(report: &'a Report, name: &str) -> &'a StageReport {
    report.stages.iter().find(|stage| stage.name == name).unwrap()
}

/// Points and constraints in memory of the device.
pub(crate) fn on_device(device: &Device, engine: &mut Engine, pslg: &Pslg) -> (Buffer<DVec2>, Buffer<[u32; 2]>) {
    let points = Buffer::new(device, "points", pslg.points().len()).unwrap();
    let constraints = Buffer::new(device, "constraints", pslg.constraints().len()).unwrap();
    engine.upload(points.view(), pslg.points()).unwrap();
    engine.upload(constraints.view(), pslg.constraints()).unwrap();
    (points, constraints)
}

/// All inputs of examples/data, or of the folder that `POLDER_DATA` names, with the names of their files.
pub(crate) fn sets() -> Vec<(String, Pslg)> {
    let folder =
        std::env::var("POLDER_DATA").unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data").into());
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "poly" || extension == "pslg"));
    paths.sort();
    let named = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, polder_io::Input::read(&path).unwrap().pslg)
    };
    paths.into_iter().map(named).collect()
}
