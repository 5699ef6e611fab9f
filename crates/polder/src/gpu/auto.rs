//! Which backend a call takes.

use super::Gpu;
use crate::{Error, Options, Output, Place, cpu, split};
use polder_mesh::Pslg;
use polder_vulkan::{Device, DeviceKind, DeviceOptions};
use std::time::Instant;

/// From so many points on [`Backend::Auto`](crate::Backend::Auto) looks for a GPU, and from half as many where the CPU may
/// use eight threads or fewer: below, opening it takes longer than the CPU needs for everything.
/// Constraints are not counted.
///
/// Measured on an NVIDIA H200 and its host, in a process that triangulates uniform points once. With kernels from the cache
/// on disk, opening takes 190 ms (Vulkan 70, the device 73, the self-test 30, kernels 15), and a million points then 12 ms.
/// The CPU takes 208 ms for them with 16 threads, 302 with 8, 360 with 4, 558 with one; so both take as long for about
/// 970,000, 650,000, 550,000 and 350,000 points. The first opening on a machine compiles all kernels: 0.7 s with 16 threads,
/// 3.5 s with one. Whoever triangulates more than once opens a [`Gpu`] and keeps it.
pub const AUTO_FROM: usize = 1_000_000;
/// The most threads that count as few.
const FEW_THREADS: usize = 8;

fn device_options(options: &Options) -> DeviceOptions {
    DeviceOptions { selection: options.device.clone(), ..DeviceOptions::default() }
}

/// On a Vulkan device, or not at all.
pub(crate) fn vulkan(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    let start = Instant::now();
    let mut gpu = Gpu::open(&device_options(options))?;
    let opening = start.elapsed().as_secs_f64();
    Ok(opened(gpu.triangulate(pslg, options)?, opening))
}

/// Says what opening the device took.
fn opened(mut output: Output, seconds: f64) -> Output {
    output.report.seconds += seconds;
    if let Some(device) = &mut output.report.device {
        device.opening_seconds = Some(seconds);
    }
    output
}

/// On a GPU where that pays and works, else on the CPU; the report says why. What is wrong with the input is wrong on both.
pub(crate) fn auto(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    let points = pslg.points().len();
    let size = match pslg.constraints().len() {
        0 => format!("{points} points"),
        constraints => format!("{points} points and {constraints} constraints"),
    };
    let threads = if options.threads == 0 { rayon::current_num_threads() } else { options.threads };
    let from = if threads > FEW_THREADS { AUTO_FROM } else { AUTO_FROM / 2 };
    if points < from {
        return on_cpu(pslg, options, format!("{size}; beside {threads} threads a GPU pays from {from} points on"));
    }
    let start = Instant::now();
    let mut gpu = match open(options) {
        Ok(gpu) => gpu,
        Err(error) => return on_cpu(pslg, options, format!("no GPU: {error}")),
    };
    let opening = start.elapsed().as_secs_f64();
    match gpu.triangulate(pslg, options) {
        Ok(output) => {
            let mut output = opened(output, opening);
            output.report.why = format!("a GPU, and {size}; beside {threads} threads it pays from {from} points on");
            Ok(output)
        }
        Err(error) if is_of_device(&error) => {
            drop(gpu);
            on_cpu(pslg, options, format!("the GPU failed: {error}"))
        }
        Err(error) => Err(error),
    }
}

/// Whether the CPU may do better.
fn is_of_device(error: &Error) -> bool {
    matches!(error.kind(), "unsupported" | "out_of_memory" | "device_lost" | "bound_exceeded" | "internal")
}

fn open(options: &Options) -> Result<Gpu, Error> {
    let device = Device::open(&device_options(options))?;
    if device.info().kind == DeviceKind::Cpu {
        let what = format!("{} is a CPU", device.info().name);
        return Err(Error::Unsupported { what });
    }
    Gpu::on(&device)
}

fn on_cpu(pslg: &Pslg, options: &Options, why: String) -> Result<Output, Error> {
    let mut output = split::by_policy(pslg, options, Place::Cpu, cpu::triangulate)?;
    output.report.why = why;
    Ok(output)
}
