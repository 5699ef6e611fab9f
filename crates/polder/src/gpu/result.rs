//! A triangulation that lies on the device.

use super::held::{Found, Held};
use crate::report::Place;
use crate::{Error, Report, StageReport};
use polder_mesh::{Chains, Parts, Triangulation};
use polder_vulkan::{Engine, View};
use std::time::Instant;

/// A triangulation in device memory, lent until the next call.
///
/// The arrays are those of [`Triangulation`], in the same order and numbering: 12 bytes a triangle for its corners
/// (`[u32; 3]`, the smallest first, counterclockwise), 12 for its neighbors ([`polder_mesh::NONE`] at the hull), 4 bytes an
/// input point for the vertex that it is or equals.
#[derive(Debug)]
pub struct OnDevice<'a> {
    engine: &'a mut Engine,
    held: Option<(&'a Held, Found)>,
    report: Report,
    started: Instant,
}

impl<'a> OnDevice<'a> {
    pub(super) fn new(engine: &'a mut Engine, held: Option<(&'a Held, Found)>, report: Report) -> Self {
        Self { engine, held, report, started: Instant::now() }
    }

    /// How it came about.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// How many triangles there are.
    pub fn triangle_count(&self) -> usize {
        self.held.as_ref().map_or(0, |(_, found)| found.canonical.triangles as usize)
    }

    /// The corners of the triangles; nothing if there was no point.
    ///
    /// # Errors
    ///
    /// None that can be caused.
    pub fn triangles(&self) -> Result<Option<View<'a, [u32; 3]>>, Error> {
        let view = |(held, _): &(&'a Held, Found)| held.canonical.triangles().slice(0..self.triangle_count());
        Ok(self.held.as_ref().map(view).transpose()?)
    }

    /// The triangle across each edge; nothing if there was no point.
    ///
    /// # Errors
    ///
    /// None that can be caused.
    pub fn neighbors(&self) -> Result<Option<View<'a, [u32; 3]>>, Error> {
        let view = |(held, _): &(&'a Held, Found)| held.canonical.neighbors().slice(0..self.triangle_count());
        Ok(self.held.as_ref().map(view).transpose()?)
    }

    /// For each input point the vertex that stands for it; nothing if there was no point.
    pub fn representatives(&self) -> Option<View<'a, u32>> {
        self.held.as_ref().map(|(held, _)| held.canonical.representatives())
    }

    /// Fetches the triangulation.
    ///
    /// # Errors
    ///
    /// [`Error::DeviceLost`].
    pub fn fetch(&mut self) -> Result<Triangulation, Error> {
        let (triangles, neighbors) = (self.triangles()?, self.neighbors()?);
        let triangles = triangles.map(|view| self.engine.download_vec(view)).transpose()?.unwrap_or_default();
        let neighbors = neighbors.map(|view| self.engine.download_vec(view)).transpose()?.unwrap_or_default();
        let representatives = self.representatives().map(|view| self.engine.download_vec(view));
        let representatives = representatives.transpose()?.unwrap_or_default();
        let parts = Parts { representatives, chains: Chains::default() };
        // No constraint, no constrained edge.
        let constrained = vec![0; triangles.len()];
        let made = Triangulation::from_canonical(triangles, neighbors, constrained, parts);
        made.map_err(|error| Error::Internal { stage: "canonical_order", what: error.to_string() })
    }

    /// Fetches it; the report then has a line for that.
    pub(super) fn into_parts(mut self) -> Result<(Triangulation, Report), Error> {
        self.started = Instant::now();
        let triangulation = self.fetch()?;
        let bytes = 24 * triangulation.triangles().len() + 4 * triangulation.representatives().len();
        let seconds = self.started.elapsed().as_secs_f64();
        let mut report = self.report;
        let counts = [("bytes", bytes as u64)].into();
        report.stages.push(StageReport { name: "download", on: Place::Transfer, seconds, counts });
        report.seconds += seconds;
        Ok((triangulation, report))
    }
}
