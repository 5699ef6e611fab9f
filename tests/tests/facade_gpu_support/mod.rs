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
    let (found, wanted) = (&output.triangulation, &expected.triangulation);
    assert_eq!(found.digest(), wanted.digest(), "{name}");
    assert_eq!(found.constrained_bits(), wanted.constrained_bits(), "{name}");
    assert_eq!(found.chains(), wanted.chains(), "{name}");
    assert!(found == wanted, "{name}");
    assert_eq!(found.neighbors(), wanted.neighbors(), "{name}");
    let Report { points, constraints, triangles, .. } = expected.report;
    let told = (&output.report.points, &output.report.constraints, output.report.triangles);
    assert_eq!(told, (&points, &constraints, triangles), "{name}");
    assert_on_device(&output.report, name);
    output.report
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
