//! Points that all lie on one line: no triangle, but duplicates have to be told nevertheless, and what constraints run
//! through.

use super::ChainsOnDevice;
use super::held::{Found, Held};
use super::work::{Input, run};
use crate::{Error, Options};
use polder_canonical::gpu::{Line, LineChains};
use polder_canonical::reference::Axis;
use polder_mesh::Chains;
use polder_voronoi::Bounds;
use polder_vulkan::{Buffer, Device, Engine, Recording, RunReport};

/// Chains of constraints among points on a line.
#[derive(Debug)]
pub(super) struct OnLine {
    pub(super) chains: LineChains,
    pub(super) vertices: Buffer<u32>,
}

impl OnLine {
    pub(super) fn chains(&self) -> ChainsOnDevice<'_> {
        ChainsOnDevice { offsets: self.chains.starts(), vertices: self.vertices.view() }
    }
}

/// Replaces what the stages have found.
pub(super) fn finish(
    (device, engine): (&Device, &mut Engine),
    input: &Input<'_>,
    bounds: &Bounds,
    held: &mut Held,
    found: &mut Found,
    options: &Options,
    runs: &mut Vec<RunReport>,
) -> Result<(), Error> {
    let points = input.points.len();
    let axis = if bounds.low().x == bounds.high().x { Axis::Y } else { Axis::X };
    let line = Line::new(device, points)?;
    let mut recording = Recording::new(device);
    recording.section("canonical_order");
    let read = line.record(&mut recording, input.points, axis, held.canonical.representatives())?;
    let Some(constraints) = input.constraints else {
        let report = run(engine, &recording, options)?;
        found.line(read.vertices(&report));
        runs.push(report);
        return Ok(());
    };
    recording.section("walk");
    let chains = LineChains::new(device, points, constraints.len())?;
    let lengths = chains.record_starts(&mut recording, &line, constraints)?;
    let report = run(engine, &recording, options)?;
    found.line(read.vertices(&report));
    let total = lengths.vertices(&report);
    found.line_chains(constraints.len(), total, lengths.through_vertices(&report));
    runs.push(report);

    let total = usize::try_from(total).ok().filter(|&total| total <= Chains::MAX_VERTICES);
    let vertices = Buffer::new(device, "chains", total.ok_or_else(crate::error::too_many_chain_vertices)?)?;
    let mut recording = Recording::new(device);
    recording.section("walk");
    chains.record_chains(&mut recording, &line, constraints, vertices.view())?;
    runs.push(run(engine, &recording, options)?);
    held.on_line = Some(OnLine { chains, vertices });
    Ok(())
}
