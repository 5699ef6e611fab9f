//! Whole triangulations with everything failing in turn that can fail.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder::{Backend, CrossingPolicy, Error, Gpu, Options, Pslg, Triangulation, triangulate};
use polder_io::generate;
use polder_vulkan::{Buffer, CacheFolder, Device, DeviceOptions, Error as EngineError, Faults};
use vulkan_support::faults::fail_everywhere;

/// An error of the facade, and the one of the engine that it stands for.
type Failed = (Error, Option<EngineError>);

fn failed(error: Error) -> Failed {
    let engine = match &error {
        Error::OutOfMemory { what } => Some(EngineError::OutOfMemory { what: what.clone(), bytes: 0, used: 0 }),
        Error::DeviceLost { what } if *what == EngineError::DeviceLost.to_string() => Some(EngineError::DeviceLost),
        Error::DeviceLost { what } if what.contains("did not finish") => Some(EngineError::Timeout { seconds: 0.0 }),
        _ => None,
    };
    (error, engine)
}

fn fail(pslg: &Pslg) -> Triangulation {
    let work = |device: &Device| -> Result<Triangulation, Failed> {
        let output = Gpu::on(device).and_then(|mut gpu| gpu.triangulate(pslg, &Options::default()));
        output.map(|output| output.triangulation).map_err(failed)
    };
    let struck = fail_everywhere(work, |(_, engine)| engine.as_ref());
    println!("{struck:?}");
    assert!(struck.refusals > 20, "{struck:?}");
    // Upload, bounds, the stages, three downloads; each is a submission at least.
    assert!(struck.losses >= 6 && struck.timeouts >= 6, "{struck:?}");
    let device = Device::open(&vulkan_support::options()).unwrap();
    work(&device).unwrap()
}

fn fails_well(pslg: &Pslg) {
    let expected = triangulate(pslg, &Options::with_backend(Backend::Cpu)).unwrap().triangulation;
    assert!(fail(pslg) == expected);
}

/// What the tests with constraints do, and less.
#[test]
#[ignore = "long"]
fn every_failure_without_constraints() {
    fails_well(&generate::clusters(300, 3, 1e-4, 5));
    fails_well(&generate::collinear(100, 5));
}

#[test]
fn every_failure_is_an_error_and_the_next_call_works() {
    fails_well(&generate::segments(300, 60, 5));
}

#[test]
fn every_failure_on_a_line() {
    let points = generate::collinear(100, 5).points().to_vec();
    fails_well(&Pslg::new(points, (0..30).map(|i| [3 * i, i]).collect()).unwrap());
}

/// Points and constraints are fetched, cut, brought back and triangulated again.
#[test]
fn failures_where_constraints_on_the_device_are_cut() {
    let pslg = generate::crossing_segments(24, 8, 1.0, 5);
    let options = Options { crossings: CrossingPolicy::Split, ..Options::with_backend(Backend::Cpu) };
    let expected = triangulate(&pslg, &options).unwrap().triangulation;
    assert!(!expected.added().is_empty());
    let folder = tempfile::tempdir().unwrap();
    let cache = CacheFolder::At(folder.path().to_owned());
    let open = || Gpu::on(&Device::open(&DeviceOptions { cache: cache.clone(), ..vulkan_support::options() }).unwrap());
    let work = |gpu: &mut Gpu| {
        let points = Buffer::new(gpu.device(), "points", pslg.points().len())?;
        let constraints = Buffer::new(gpu.device(), "constraints", pslg.constraints().len())?;
        gpu.engine().upload(points.view(), pslg.points())?;
        gpu.engine().upload(constraints.view(), pslg.constraints())?;
        gpu.triangulate_constrained_on_device(points.view(), constraints.view(), &options)?.fetch()
    };
    let mut gpu = open().unwrap();
    assert!(work(&mut gpu).unwrap() == expected);
    gpu.device().save_pipelines();
    // The first index at which nothing strikes any more.
    let in_turn = |gpu: &mut Gpu, set: &dyn Fn(&Faults, u64), step: usize, kind: &str| {
        for index in (0..).step_by(step) {
            gpu.release();
            set(gpu.device().faults(), index);
            let done = work(gpu);
            gpu.device().faults().clear();
            match done {
                Ok(found) => {
                    assert!(found == expected);
                    return index;
                }
                Err(error) => assert_eq!(error.kind(), kind, "{index}: {error}"),
            }
        }
        0
    };
    let refusals = in_turn(&mut gpu, &Faults::refuse_allocation, 3, "out_of_memory");
    let timeouts = in_turn(&mut gpu, &Faults::time_out_at_submission, 1, "device_lost");
    // Each loss takes a new device: before, while and after constraints are cut.
    for index in (0..timeouts).step_by(5) {
        let mut gpu = open().unwrap();
        gpu.device().faults().lose_at_submission(index);
        assert_eq!(work(&mut gpu).unwrap_err().kind(), "device_lost");
        assert_eq!(work(&mut gpu).unwrap_err().kind(), "device_lost");
    }
    println!("{refusals} refusals, {timeouts} submissions");
    assert!(refusals > 50 && timeouts > 12, "{refusals}, {timeouts}");
    assert_eq!(gpu.device().validation_messages(), Vec::<String>::new());
    assert_eq!(gpu.device().overruns(), Vec::<String>::new());
}

/// What a wait has given up on may still be at work on the memory that the next call uses.
#[test]
fn a_gpu_that_timed_out_is_good_for_the_next_call() {
    let pslgs = [generate::uniform(300, 6), generate::collinear(100, 6), generate::segments(300, 60, 6)];
    let mut gpu = Gpu::on(&Device::open(&vulkan_support::options()).unwrap()).unwrap();
    for pslg in &pslgs {
        let expected = triangulate(pslg, &Options::with_backend(Backend::Cpu)).unwrap().triangulation;
        for index in 0.. {
            gpu.device().faults().time_out_at_submission(index);
            let done = gpu.triangulate(pslg, &Options::default());
            gpu.device().faults().clear();
            match done {
                Ok(output) => {
                    assert!(output.triangulation == expected && index > 5);
                    break;
                }
                Err(error) => assert!(matches!(error, Error::DeviceLost { .. }), "{index}: {error}"),
            }
            assert!(gpu.triangulate(pslg, &Options::default()).unwrap().triangulation == expected, "{index}");
        }
    }
    assert_eq!(gpu.device().validation_messages(), Vec::<String>::new());
    assert_eq!(gpu.device().overruns(), Vec::<String>::new());
}
