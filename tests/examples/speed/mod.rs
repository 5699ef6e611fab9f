//! What the examples that measure a stage share: cases from the command line, input in device memory, medians.
#![allow(dead_code, reason = "each takes what it needs")]

use polder_mesh::Pslg;
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, Recording, RunOptions};
use std::time::{Duration, Instant};

pub(crate) type Failure = Box<dyn std::error::Error>;

const RUNS: usize = 10;
/// For so long it runs unmeasured before: a device that has slept runs at low clocks for a while.
const WARM: Duration = Duration::from_millis(700);

/// Prepares the cases that the command line names, all at once, since that takes longer than measuring; then measures one
/// after the other on the device that `POLDER_DEVICE` names.
pub(crate) fn each<T: Send + 'static>(
    default: &str,
    prepare: fn(&str) -> Result<T, Failure>,
    measure: impl Fn(&Device, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let device = Device::open(&DeviceOptions::default())?;
    println!("{}", device.info());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cases = if arguments.is_empty() { vec![default.to_owned()] } else { arguments };
    let prepared = move |case: String| prepare(&case).map_err(|error| format!("{case}: {error}"));
    let threads: Vec<_> = cases.into_iter().map(|case| std::thread::spawn(move || prepared(case))).collect();
    for thread in threads {
        measure(&device, thread.join().map_err(|_| "a thread panicked")??)?;
    }
    Ok(())
}

/// The points of a case `family:points`.
pub(crate) fn family(case: &str) -> Result<Pslg, Failure> {
    let (family, points) = case.split_once(':').ok_or("a case is family:points")?;
    let families = polder_tests::point_families(points.parse()?, 1);
    Ok(families.into_iter().find(|(name, _)| *name == family).ok_or("no such family")?.1)
}

pub(crate) fn uploaded<T: bytemuck::Pod>(
    device: &Device,
    engine: &mut Engine,
    data: &[T],
) -> Result<Buffer<T>, Failure> {
    let buffer = Buffer::new(device, "uploaded", data.len())?;
    engine.upload(buffer.view(), data)?;
    Ok(buffer)
}

/// Prints the medians of some runs, by the clock and by timestamps, and what each kernel took in the last one. What
/// `restore` does before each run is not counted.
pub(crate) fn time(engine: &mut Engine, restore: Option<&Recording>, recording: &Recording) -> Result<(), Failure> {
    let mut run = |timestamps| -> Result<_, Failure> {
        if let Some(restore) = restore {
            engine.run(restore, &RunOptions::default())?;
        }
        let start = Instant::now();
        let report = engine.run(recording, &RunOptions { timestamps, ..RunOptions::default() })?;
        Ok((start.elapsed(), report))
    };
    let warm = Instant::now();
    while warm.elapsed() < WARM {
        run(false)?;
    }
    let [mut kernels, mut clock] = [Vec::new(), Vec::new()];
    for _ in 1..RUNS {
        clock.push(run(false)?.0);
        kernels.push(run(true)?.1.timings.total());
    }
    clock.push(run(false)?.0);
    let report = run(true)?.1;
    kernels.push(report.timings.total());
    kernels.sort();
    clock.sort();
    let micros = |time: Duration| time.as_secs_f64() * 1e6;
    println!(
        "  kernels {:.1} us, by clock {:.1} us, {} dispatches, {} waits",
        micros(kernels[RUNS / 2]),
        micros(clock[RUNS / 2]),
        report.dispatches,
        report.waits
    );
    let mut kernels: Vec<_> = report.timings.iter().collect();
    kernels.sort_by_key(|(_, timing)| std::cmp::Reverse(timing.total_ns));
    for (name, timing) in kernels {
        let us = |ns: u64| ns as f64 / 1e3;
        let (total, longest) = (us(timing.total_ns), us(timing.longest_ns));
        println!("    {name:24} {total:9.1} us in {:4}, longest {longest:.1}", timing.count);
    }
    Ok(())
}
