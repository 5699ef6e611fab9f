//! Constraints on the device that cross: fetched, cut in the host's memory, and their pieces triangulated on the device.

use super::work::Input;
use super::{ChainsOnDevice, Gpu, OnDevice, Uploaded, internal};
use crate::report::{Place, Stopwatch};
use crate::split::{self, Split};
use crate::{AddedVertex, Error, Options};
use polder_mesh::DVec2;
use polder_vulkan::{Buffer, View};

/// What cutting made, beside the triangulation of the pieces.
#[derive(Debug)]
pub(super) struct Cut {
    added: Vec<AddedVertex>,
    /// The input's points and the added ones behind them, and the pieces.
    input: Uploaded,
    /// The chains of the constraints, not of their pieces.
    offsets: Buffer<u32>,
    vertices: Buffer<u32>,
}

impl Cut {
    pub(super) fn added(&self) -> &[AddedVertex] {
        &self.added
    }

    pub(super) fn points(&self) -> View<'_, DVec2> {
        self.input.points.view()
    }

    pub(super) fn chains(&self) -> ChainsOnDevice<'_> {
        ChainsOnDevice { offsets: self.offsets.view(), vertices: self.vertices.view() }
    }
}

impl Gpu {
    /// Cuts an input whose constraints were found to cross, and triangulates the pieces; `watch` has run since the call.
    pub(super) fn cut(
        &mut self,
        given: Input<'_>,
        options: &Options,
        mut watch: Stopwatch,
    ) -> Result<OnDevice<'_>, Error> {
        watch.stage_on(Place::Device, "crossings_met", []);
        let pslg = given.download(&mut self.engine)?;
        let bytes = size_of_val(pslg.points()) + size_of_val(pslg.constraints());
        watch.stage_on(Place::Transfer, "fetch", [("bytes", bytes as u64)]);
        let split = split::split(&pslg, options)?;
        watch.stage("split", split.counts());

        let Split { pslg: pieces, added, chains, .. } = split;
        let input = self.upload(&pieces)?;
        let offsets = Buffer::new(&self.device, "chain offsets", chains.offsets().len())?;
        let vertices = Buffer::new(&self.device, "chains", chains.vertices().len())?;
        self.engine.upload(offsets.view(), chains.offsets())?;
        self.engine.upload(vertices.view(), chains.vertices())?;
        let bytes = input.bytes() + size_of_val(chains.offsets()) + size_of_val(chains.vertices());
        watch.stage_on(Place::Transfer, "upload", [("bytes", bytes as u64)]);

        let done = self.work(input.on_device(), options, watch).map_err(split::pieces_cross);
        let (found, mut report) = done?;
        let vertices_of_result = report.points.vertices;
        report.points.total = pslg.points().len();
        report.points.added = added.len();
        report.points.duplicates = report.points.total + added.len() - vertices_of_result;
        report.constraints.total = chains.len();
        report.constraints.through_vertices = chains.iter().filter(|chain| chain.len() > 2).count();
        let held = self.held.as_mut().ok_or_else(|| internal("no memory was made"))?;
        held.cut = Some(Cut { added, input, offsets, vertices });
        Ok(self.result(found, report))
    }
}
