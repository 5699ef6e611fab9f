//! Which backend a call takes.

use super::Gpu;
use crate::{Error, Options, Output, cpu};
use polder_mesh::Pslg;
use polder_vulkan::{Device, DeviceKind, DeviceOptions};

/// From so many points on [`Backend::Auto`](crate::Backend::Auto) looks for a GPU: below, opening it takes about as long as
/// the CPU needs for everything.
///
/// Measured on an NVIDIA H200 beside 16 cores: the CPU takes 0.19 s for a million uniform points and 2.1 s for ten, the GPU
/// from host to host 0.02 s and 0.11 s once it is open. Opening it took 3.4 s with every kernel to be compiled, which happens
/// once on a machine; with kernels from the cache a few tenths of a second are assumed here, not measured.
pub const AUTO_FROM: usize = 2_000_000;

fn device_options(options: &Options) -> DeviceOptions {
    DeviceOptions { selection: options.device.clone(), ..DeviceOptions::default() }
}

/// On a Vulkan device, or not at all.
pub(crate) fn vulkan(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    refuse_constraints(pslg)?;
    Gpu::open(&device_options(options))?.triangulate(pslg, options)
}

pub(super) fn refuse_constraints(pslg: &Pslg) -> Result<(), Error> {
    if pslg.constraints().is_empty() {
        return Ok(());
    }
    let what = "constraints are not inserted on Vulkan devices yet; use the backend cpu".to_owned();
    Err(Error::Unsupported { what })
}

/// On a GPU where that pays and works, else on the CPU; the report says why.
pub(crate) fn auto(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    let points = pslg.points().len();
    if points < AUTO_FROM {
        return on_cpu(pslg, options, format!("{points} points; a GPU pays from {AUTO_FROM} on"));
    }
    match on_gpu(pslg, options) {
        Ok(mut output) => {
            output.report.why = format!("a GPU, and {points} points; it pays from {AUTO_FROM} on");
            Ok(output)
        }
        Err(error @ Error::Cancelled(_)) => Err(error),
        Err(error) => on_cpu(pslg, options, format!("no GPU: {error}")),
    }
}

fn on_gpu(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    refuse_constraints(pslg)?;
    let device = Device::open(&device_options(options))?;
    if device.info().kind == DeviceKind::Cpu {
        let what = format!("{} is a CPU", device.info().name);
        return Err(Error::Unsupported { what });
    }
    Gpu::on(&device)?.triangulate(pslg, options)
}

fn on_cpu(pslg: &Pslg, options: &Options, why: String) -> Result<Output, Error> {
    let mut output = cpu::triangulate(pslg, options)?;
    output.report.why = why;
    Ok(output)
}
