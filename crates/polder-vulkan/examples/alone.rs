//! The engine alone: lists devices, opens the one that `POLDER_DEVICE` names (else the best), and scans an array.
//!
//! `cargo run -p polder-vulkan --example alone`; on a machine without a GPU, `POLDER_DEVICE=lavapipe` before it.

use polder_vulkan::primitives::Scan;
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Error, Instance, Recording, RunOptions};

fn main() -> Result<(), Error> {
    let instance = Instance::load(false)?;
    for info in instance.devices()? {
        println!("{info}");
    }
    let device = Device::open_on(&instance, &DeviceOptions::default())?;
    println!("\non {}: {}", device.info().name, device.self_test()?);

    let words: Vec<u32> = (0..1_000_000).collect();
    Scan::estimate(words.len()).buffer::<u32>("words", words.len()).check(&device)?;
    let buffer = Buffer::new(&device, "words", words.len())?;
    let total = Buffer::new(&device, "total", 1)?;
    let scan = Scan::new(&device, words.len())?;
    let mut engine = Engine::new(&device)?;
    engine.upload(buffer.view(), &words)?;

    let mut recording = Recording::new(&device);
    scan.record(&mut recording, words.len(), buffer.view(), buffer.view(), Some(total.view()));
    let sum = recording.read(total.view());
    let report = engine.run(&recording, &RunOptions { timestamps: true, ..RunOptions::default() })?;

    let scanned = engine.download_vec(buffer.view())?;
    println!("the sum of all, modulo 2^32: {}; before the last: {}", report.word(sum), scanned[words.len() - 1]);
    println!("{} barriers, {} submission\n\n{}", report.barriers, report.submissions, report.timings);
    Ok(())
}
