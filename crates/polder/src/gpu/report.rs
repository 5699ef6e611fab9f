//! What the report says of work on a device.

use super::Gpu;
use super::held::Found;
use crate::report::{Place, Stopwatch};
use crate::{KernelReport, Report, StageReport};
use polder_flip::gpu::Arithmetic;
use polder_vulkan::{DeviceKind, RunReport};

impl Gpu {
    /// Constraints of zero length and repeated ones are left to whoever fetches the chains.
    pub(super) fn report(
        &self,
        watch: Stopwatch,
        (points, constraints): (usize, usize),
        found: Option<&Found>,
        runs: &[RunReport],
    ) -> Report {
        let info = self.device.info();
        let mut report = Report::started(watch);
        report.backend = "vulkan";
        report.why = "asked for".into();
        report.way = match constraints {
            0 => "digital Voronoi diagram, dualized, shifted, missing points inserted, flips, canonical order",
            _ => {
                "digital Voronoi diagram, dualized, shifted, missing points inserted, constraints by flips, flips, canonical order"
            }
        };
        report.device = Some(crate::DeviceReport {
            name: info.name.clone(),
            kind: match info.kind {
                DeviceKind::Discrete => "discrete",
                DeviceKind::Integrated => "integrated",
                DeviceKind::Virtual => "virtual",
                DeviceKind::Cpu => "cpu",
                _ => "other",
            },
            driver: info.driver.clone(),
            arithmetic: match self.arithmetic {
                Arithmetic::Filtered => "f64 first, then integers",
                Arithmetic::Integers => "integers",
            },
            opening_seconds: None,
            host_waits: runs.iter().map(|run| run.waits).sum(),
            dispatches: runs.iter().map(|run| run.dispatches).sum(),
            peak_bytes: self.device.memory_use().peak,
            kernels: runs.iter().flat_map(kernels).collect(),
        });
        let seconds = |name: &str| {
            let ns = runs.iter().filter_map(|run| run.sections.get(name)).map(|timing| timing.total_ns);
            ns.sum::<u64>() as f64 * 1e-9
        };
        let counts = found.map(Found::counts).unwrap_or_default();
        for (name, counts) in counts {
            let seconds = seconds(name);
            report.stages.push(StageReport { name, on: Place::Device, seconds, counts: counts.into_iter().collect() });
        }
        if let Some(found) = found {
            let vertices = found.canonical.vertices as usize;
            report.points.total = points;
            report.points.vertices = vertices;
            report.points.duplicates = points - vertices;
            report.triangles = found.canonical.triangles as usize;
            report.constraints.total = constraints;
            report.constraints.through_vertices = found.canonical.through_vertices as usize;
            report.constraints.constrained_edges = found.canonical.constrained_edges as usize;
        }
        report
    }
}

/// The kernels of a run, stage by stage.
fn kernels(run: &RunReport) -> Vec<KernelReport> {
    let mut kernels = Vec::new();
    for (&stage, timings) in &run.by_section {
        for (name, timing) in timings.iter() {
            kernels.push(KernelReport { stage, name, count: timing.count, seconds: timing.total_ns as f64 * 1e-9 });
        }
    }
    kernels
}
