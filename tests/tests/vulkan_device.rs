//! Devices: which one is taken, what it is asked, and what happens when it fails.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_vulkan::primitives::{Compact, Scan, Sort};
use polder_vulkan::{
    Buffer, CacheFolder, Device, DeviceKind, DeviceOptions, Engine, Error, Estimate, Feature, Instance, Recording,
    RunOptions, Selection,
};
use std::time::Duration;
use vulkan_support::{Gpu, options, words};

#[test]
fn a_device_is_taken_by_index_and_by_name() {
    let instance = Instance::load(false).unwrap();
    let devices = instance.devices().unwrap();
    assert!(!devices.is_empty());
    for info in devices.iter().filter(|info| info.usable()) {
        let index = DeviceOptions { selection: Selection::Index(info.index), cache: CacheFolder::Off, ..options() };
        assert_eq!(Device::open_on(&instance, &index).unwrap().info().index, info.index);
        let name = Selection::parse(&info.name.to_uppercase());
        let name = DeviceOptions { selection: name, cache: CacheFolder::Off, ..options() };
        assert_eq!(Device::open_on(&instance, &name).unwrap().info().name, info.name);
        let text = info.to_string();
        assert!(text.contains(&info.name) && text.contains("timelineSemaphore"), "{text}");
    }
    for selection in [Selection::Index(99), Selection::parse("no such device")] {
        let missing = DeviceOptions { selection, cache: CacheFolder::Off, ..options() };
        match Device::open_on(&instance, &missing) {
            Err(Error::NoDevice { found, .. }) => assert!(found.contains(&devices[0].name), "{found}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_cpu_is_taken_only_when_asked_for() {
    let instance = Instance::load(false).unwrap();
    let best = DeviceOptions { selection: Selection::Best, cache: CacheFolder::Off, ..options() };
    match Device::open_on(&instance, &best) {
        Ok(device) => assert_ne!(device.info().kind, DeviceKind::Cpu),
        Err(error) => {
            assert!(matches!(error, Error::NoDevice { .. }), "{error}");
            assert!(instance.devices().unwrap().iter().all(|info| info.kind == DeviceKind::Cpu || !info.usable()));
        }
    }
}

#[test]
fn f64_is_tested_at_start_up() {
    let gpu = Gpu::open();
    let found = gpu.device.self_test().unwrap();
    assert_eq!(found.passed(), gpu.device.has(Feature::ShaderFloat64), "{found}");
    assert_eq!(gpu.device.self_test().unwrap(), found);
}

#[test]
fn what_does_not_fit_says_so_before_any_work() {
    let cap = 1 << 20;
    let gpu = Gpu::with(&DeviceOptions { memory_cap: Some(cap), ..options() });
    assert!(gpu.device.available_memory() <= cap);
    let fits = Estimate::new().buffer::<u32>("a", 1000).and(Scan::estimate(1000));
    assert_eq!((fits.check(&gpu.device), fits.bytes()), (Ok(()), 4016));
    let estimate = Estimate::new().buffer::<u64>("a", 100_000).and(Estimate::new().buffer::<u8>("b", 300_000));
    match estimate.check(&gpu.device) {
        Err(Error::TooLarge { needed: 1_100_000, available, .. }) => assert_eq!(available, cap),
        other => panic!("{other:?}"),
    }
    match Estimate::new().buffer::<u64>("huge", usize::MAX).check(&gpu.device) {
        Err(Error::TooLarge { what, .. }) => assert!(what.contains("huge"), "{what}"),
        other => panic!("{other:?}"),
    }
    assert!(matches!(Buffer::<u64>::new(&gpu.device, "huge", usize::MAX), Err(Error::TooLarge { .. })));
    assert!(matches!(Buffer::<u32>::new(&gpu.device, "over", 300_000), Err(Error::OutOfMemory { .. })));
    let first = Buffer::<u8>::new(&gpu.device, "most", 1_000_000).unwrap();
    assert!(matches!(Buffer::<u8>::new(&gpu.device, "over", 100_000), Err(Error::OutOfMemory { .. })));
    assert_eq!(gpu.device.memory_use().used, 1_000_000);
    drop(first);
    assert_eq!((gpu.device.memory_use().used, gpu.device.memory_use().peak), (0, 1_000_000));
}

#[test]
fn an_estimate_is_what_is_held() {
    let gpu = Gpu::open();
    let estimate = Sort::<u64>::estimate(&gpu.device, 12_345);
    let sort = Sort::<u64>::new(&gpu.device, 12_345).unwrap();
    assert_eq!(gpu.device.memory_use().used, estimate.bytes());
    let (scan, compact) = (Scan::new(&gpu.device, 9).unwrap(), Compact::new(&gpu.device, 9).unwrap());
    let all = estimate.and(Scan::estimate(9)).and(Compact::estimate(9));
    assert_eq!(gpu.device.memory_use().used, all.bytes());
    drop((sort, scan, compact));
    assert_eq!(gpu.device.memory_use().used, 0);
}

#[test]
fn buffers_grow_by_half() {
    let gpu = Gpu::open();
    let mut buffer = Buffer::<u32>::new(&gpu.device, "growing", 1000).unwrap();
    assert!(!buffer.resize(10).unwrap() && buffer.len() == 10 && !buffer.resize(1000).unwrap());
    assert!(buffer.resize(1001).unwrap());
    assert_eq!((buffer.len(), gpu.device.memory_use().used), (1001, 6000));
    assert!(!buffer.resize(1500).unwrap());
    assert!(buffer.resize(9000).unwrap());
    assert_eq!(gpu.device.memory_use().used, 36_000);
    gpu.device.faults().refuse_allocation(1);
    // With growth refused, what is needed is still given.
    assert!(buffer.resize(10_000).unwrap());
    assert_eq!(gpu.device.memory_use().used, 40_000);
}

/// A driver leaves something to do to the end of each thread that ran its code, so it must be there then.
#[test]
fn threads_may_end_after_their_devices() {
    for _ in 0..8 {
        let (send, devices) = std::sync::mpsc::channel();
        let (let_go, ends) = std::sync::mpsc::channel::<()>();
        let thread = std::thread::spawn(move || {
            let gpu = Gpu::open();
            work(&gpu.device).unwrap();
            send.send(gpu).unwrap();
            ends.recv().unwrap();
        });
        drop(devices.recv().unwrap());
        let_go.send(()).unwrap();
        thread.join().unwrap();
    }
}

/// Everything that can fail, in one piece of work.
fn work(device: &Device) -> Result<Vec<u32>, Error> {
    let len = 5000;
    let mut engine = Engine::new(device)?;
    let (scan, sort) = (Scan::new(device, len)?, Sort::<u32>::new(device, len)?);
    let buffer = Buffer::<u32>::new(device, "words", len)?;
    let total = Buffer::<u32>::new(device, "total", 1)?;
    engine.upload(buffer.view(), &words(1, len))?;
    let mut recording = Recording::new(device);
    sort.record(&mut recording, len, buffer.view(), None, 32);
    recording.fill(total.view(), 0);
    recording.repeat("once", total.view(), 1, 1, |body| {
        scan.record(body, len, buffer.view(), buffer.view(), None);
    });
    scan.record(&mut recording, len, buffer.view(), buffer.view(), None);
    engine.run(&recording, &RunOptions { timestamps: true, ..RunOptions::default() })?;
    engine.download_vec(buffer.view())
}

#[test]
fn a_device_lost_at_any_submission_is_an_error_and_the_next_one_works() {
    let expected = work(&Gpu::open().device).unwrap();
    for index in 0.. {
        let gpu = Gpu::open();
        gpu.device.faults().lose_at_submission(index);
        match work(&gpu.device) {
            Err(error) => {
                assert_eq!((error, gpu.device.is_lost()), (Error::DeviceLost, true));
                assert_eq!(gpu.device.memory_use().used, 0);
                assert_eq!(work(&gpu.device), Err(Error::DeviceLost));
            }
            Ok(found) => {
                assert!(index == 4 && found == expected);
                break;
            }
        }
        assert_eq!(work(&Gpu::open().device).as_ref(), Ok(&expected));
    }
}

#[test]
fn any_allocation_refused_is_an_error_and_the_next_call_works() {
    let gpu = Gpu::open();
    let expected = work(&gpu.device).unwrap();
    for index in 0.. {
        gpu.device.faults().refuse_allocation(index);
        match work(&gpu.device) {
            Err(error) => assert!(matches!(error, Error::OutOfMemory { .. }), "{error}"),
            Ok(found) => {
                assert!(index == 10 && found == expected, "{index}");
                break;
            }
        }
        assert_eq!(gpu.device.memory_use().used, 0);
        gpu.device.faults().clear();
        assert_eq!(work(&gpu.device).as_ref(), Ok(&expected));
    }
}

#[test]
fn a_time_out_at_any_submission_keeps_what_is_in_flight() {
    let gpu = Gpu::open();
    let expected = work(&gpu.device).unwrap();
    for index in 0..4 {
        gpu.device.faults().time_out_at_submission(index);
        assert!(matches!(work(&gpu.device), Err(Error::Timeout { .. })));
        assert_eq!(gpu.device.memory_use().used, 0);
        gpu.device.faults().clear();
        assert_eq!(work(&gpu.device).as_ref(), Ok(&expected));
    }
}

#[test]
fn an_engine_goes_on_after_a_time_out() {
    let mut gpu = Gpu::open();
    let sort = Sort::<u64>::new(&gpu.device, 1 << 18).unwrap();
    let keys = Buffer::<u64>::new(&gpu.device, "keys", 1 << 18).unwrap();
    gpu.engine.upload(keys.view(), &vec![3; 1 << 18]).unwrap();
    let mut recording = gpu.recording();
    sort.record(&mut recording, 1 << 18, keys.view(), None, 64);
    // On a fast device this may well be done in time.
    let options = RunOptions { timeout: Duration::ZERO, timestamps: true, ..RunOptions::default() };
    for _ in 0..3 {
        let done = gpu.engine.run(&recording, &options);
        assert!(done.is_ok() || matches!(done, Err(Error::Timeout { .. })), "{done:?}");
    }
    // What is parked keeps its buffers alive, so these may go before it is done.
    drop((sort, recording));
    assert!(gpu.fetch(keys.view()) == vec![3; 1 << 18]);
}

#[test]
fn kernels_are_compiled_once_a_device() {
    let gpu = Gpu::open();
    let first = (Sort::<u32>::new(&gpu.device, 500).unwrap(), Compact::new(&gpu.device, 500).unwrap());
    let compiled = gpu.device.pipelines();
    assert_eq!(compiled, 10);
    // Other lengths, also after the first ones are gone, and from several threads.
    drop(first);
    std::thread::scope(|scope| {
        for len in [9, 4000, 100_000] {
            let device = &gpu.device;
            scope.spawn(move || (Sort::<u32>::new(device, len).unwrap(), Compact::new(device, len).unwrap()));
        }
    });
    assert_eq!(gpu.device.pipelines(), compiled);
    drop(Sort::<u64>::new(&gpu.device, 500).unwrap());
    assert_eq!(gpu.device.pipelines(), compiled + 2);
}

#[test]
fn pipelines_are_kept_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let cached = DeviceOptions { cache: CacheFolder::At(folder.path().join("new")), ..options() };
    let expected = work(&Gpu::with(&cached).device).unwrap();
    let files: Vec<_> =
        std::fs::read_dir(folder.path().join("new")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(files.len(), 1);
    assert_eq!(work(&Gpu::with(&cached).device).as_ref(), Ok(&expected));
    // What was damaged is not used.
    let mut bytes = std::fs::read(&files[0]).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    std::fs::write(&files[0], bytes).unwrap();
    assert_eq!(work(&Gpu::with(&cached).device).as_ref(), Ok(&expected));
}
