//! A device for a test: the one that `POLDER_DEVICE` names, watched by the validation layer (`POLDER_VALIDATION=0` does
//! without, where there is none). Without a device the test fails; so it does when the layer says anything, and when a
//! kernel has written past the end of a buffer.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

pub(crate) mod faults;

use polder_vulkan::{
    Buffer, CacheFolder, Device, DeviceOptions, Engine, Recording, RunOptions, RunReport, Selection, View,
};
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

pub(crate) struct Gpu {
    pub(crate) device: Device,
    pub(crate) engine: Engine,
}

/// Watched, and with guard zones around every buffer; or neither. Guard zones are read by the host, which takes long on a
/// GPU: `POLDER_GUARDED=0` does without them.
pub(crate) fn options() -> DeviceOptions {
    let is_on = |variable| std::env::var(variable).as_deref() != Ok("0");
    let watched = is_on("POLDER_VALIDATION");
    DeviceOptions {
        selection: Selection::Environment,
        validation: watched,
        guarded: watched && is_on("POLDER_GUARDED"),
        memory_cap: None,
        cache: CacheFolder::Off,
    }
}

impl Gpu {
    pub(crate) fn open() -> Gpu {
        Gpu::with(&options())
    }

    pub(crate) fn with(options: &DeviceOptions) -> Gpu {
        let device = Device::open(options).unwrap();
        Gpu { engine: Engine::new(&device).unwrap(), device }
    }

    pub(crate) fn buffer<T: bytemuck::Pod>(&mut self, data: &[T]) -> Buffer<T> {
        let buffer = Buffer::new(&self.device, "test", data.len()).unwrap();
        self.engine.upload(buffer.view(), data).unwrap();
        buffer
    }

    pub(crate) fn recording(&self) -> Recording {
        Recording::new(&self.device)
    }

    pub(crate) fn run(&mut self, recording: &Recording) -> RunReport {
        self.engine.run(recording, &RunOptions::default()).unwrap()
    }

    pub(crate) fn fetch<T: bytemuck::Pod>(&mut self, view: View<'_, T>) -> Vec<T> {
        self.engine.download_vec(view).unwrap()
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_eq!(self.device.validation_messages(), Vec::<String>::new());
            assert_eq!(self.device.overruns(), Vec::<String>::new());
        }
    }
}

pub(crate) fn random(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

pub(crate) fn words(seed: u64, len: usize) -> Vec<u32> {
    let mut random = random(seed);
    (0..len).map(|_| random.next_u32()).collect()
}

pub(crate) fn wide(seed: u64, len: usize) -> Vec<u64> {
    let mut random = random(seed);
    (0..len).map(|_| random.next_u64()).collect()
}

/// Lengths around everything that a kernel divides by, up to 2^20.
pub(crate) fn lengths() -> Vec<usize> {
    let mut lengths = vec![0, 1, 2, 3, 4, 5, 7, 8, 9, 1 << 20];
    for power in [5, 7, 8, 9, 10, 11, 12, 13, 16, 17] {
        lengths.extend([(1 << power) - 1, 1 << power, (1 << power) + 1]);
    }
    let mut random = random(17);
    lengths.extend((0..6).map(|_| (random.next_u32() % (1 << 18)) as usize));
    lengths
}
