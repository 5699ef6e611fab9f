//! A triangulation that lies on the device.

use super::cut::Cut;
use super::held::{Found, Held};
use super::internal;
use crate::report::Place;
use crate::{AddedVertex, Error, Report, StageReport};
use polder_mesh::{Arrays, Chains, DVec2, Parts, Pslg, Triangulation};
use polder_vulkan::{Downloads, Engine, View, room_for};
use rayon::iter::{ParallelExtend, repeat_n};
use std::time::Instant;

/// From so many points on memory for the result is made while the device works.
const LARGE: usize = 100_000;

/// A triangulation in device memory, lent until the next call.
///
/// The arrays are those of [`Triangulation`], in the same order and numbering: 12 bytes a triangle for its corners
/// (`[u32; 3]`, the smallest first, counterclockwise), 12 for its neighbors ([`polder_mesh::NONE`] at the hull), a byte for
/// its constrained edges (bit `k` for the edge opposite corner `k`, which is the one that neighbor `k` lies across), 4 bytes
/// an input point for the vertex that it is or equals. The vertices along constraints are [`ChainsOnDevice`].
#[derive(Debug)]
pub struct OnDevice<'a> {
    engine: &'a mut Engine,
    held: Option<(&'a Held, Found)>,
    report: Report,
    started: Instant,
}

/// For each constraint the vertices along it from its first end to its second, in device memory: chain `i` is
/// `vertices[offsets[i]..offsets[i + 1]]`, of one vertex where a constraint has no length.
#[derive(Clone, Copy, Debug)]
pub struct ChainsOnDevice<'a> {
    /// One number more than constraints: where chains begin, and where the last one ends.
    pub offsets: View<'a, u32>,
    /// The vertices of all chains, one chain behind the other.
    pub vertices: View<'a, u32>,
}

impl<'a> OnDevice<'a> {
    pub(super) fn new(engine: &'a mut Engine, held: Option<(&'a Held, Found)>, report: Report) -> Self {
        Self { engine, held, report, started: Instant::now() }
    }

    /// How it came about. Of constraints the numbers are told; which ones have no length or repeat others is told once
    /// the triangulation has been [fetched](Self::fetch).
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

    /// A byte for each triangle, whose bit `k` says that edge `k` is constrained; nothing if there was no point.
    ///
    /// # Errors
    ///
    /// None that can be caused.
    pub fn constrained(&self) -> Result<Option<View<'a, u8>>, Error> {
        let view = |(held, _): &(&'a Held, Found)| held.canonical.constrained().slice(0..self.triangle_count());
        Ok(self.held.as_ref().map(view).transpose()?)
    }

    /// The vertices along each constraint; nothing if there was no constraint.
    ///
    /// # Errors
    ///
    /// None that can be caused.
    pub fn chains(&self) -> Result<Option<ChainsOnDevice<'a>>, Error> {
        match &self.held {
            Some((held, found)) => held.chains(found),
            None => Ok(None),
        }
    }

    /// The vertices that were added where constraints cross, and of which constraints: vertex `points + i` is `added()[i]`.
    pub fn added(&self) -> &'a [AddedVertex] {
        let cut = self.held.as_ref().and_then(|(held, _)| held.cut.as_ref());
        cut.map_or(&[], Cut::added)
    }

    /// Where constraints were cut, the positions of all points and, behind them, of the [added](Self::added) vertices.
    pub fn cut_points(&self) -> Option<View<'a, DVec2>> {
        let (held, _) = self.held.as_ref()?;
        held.cut.as_ref().map(Cut::points)
    }

    /// For each input point, and each added one, the vertex that stands for it; nothing if there was no point.
    pub fn representatives(&self) -> Option<View<'a, u32>> {
        self.held.as_ref().map(|(held, _)| held.canonical.representatives())
    }

    /// Fetches the triangulation.
    ///
    /// # Errors
    ///
    /// [`Error::DeviceLost`].
    pub fn fetch(&mut self) -> Result<Triangulation, Error> {
        let mut into = Triangulation::default();
        self.fetch_into(&mut into)?;
        Ok(into)
    }

    /// Fetches the triangulation into the memory of another one, which is no longer needed: fresh memory costs about as much
    /// as bringing the bytes. After an error it is empty.
    ///
    /// # Errors
    ///
    /// [`Error::DeviceLost`].
    pub fn fetch_into(&mut self, into: &mut Triangulation) -> Result<(), Error> {
        let Arrays { mut triangles, mut neighbors, mut constrained, parts } = std::mem::take(into).into_arrays();
        let Parts { mut representatives, chains } = parts;
        let (mut offsets, mut vertices) = chains.into_parts();
        let mut downloads = Downloads::new();
        if let (Some(from), Some(across), Some(of)) = (self.triangles()?, self.neighbors()?, self.representatives()) {
            downloads = downloads.and(from, &mut triangles).and(across, &mut neighbors).and(of, &mut representatives);
        } else {
            (triangles, neighbors, representatives) = Default::default();
        }
        let chains = self.chains()?.zip(self.constrained()?);
        if let Some((chains, bits)) = chains {
            downloads = downloads.and(bits, &mut constrained);
            downloads = downloads.and(chains.offsets, &mut offsets).and(chains.vertices, &mut vertices);
        }
        self.engine.fetch(downloads)?;
        let chains = match chains {
            Some(_) => Chains::from_parts(offsets, vertices).ok_or_else(|| internal("chains do not fit together"))?,
            None => {
                // No constraint, no constrained edge.
                constrained.clear();
                constrained.par_extend(repeat_n(0, triangles.len()));
                Chains::default()
            }
        };
        self.report.constraints.name_needless(&chains);
        let parts = Parts { representatives, chains: Chains::default() };
        let made = Triangulation::from_canonical(triangles, neighbors, constrained, parts);
        let made = made.map_err(|error| Error::Internal { stage: "canonical_order", what: error.to_string() })?;
        *into = made.with_added(self.added().to_vec(), chains);
        Ok(())
    }

    /// Fetches it into some room; the report then has a line for that.
    pub(super) fn into_parts(mut self, room: Triangulation) -> Result<(Triangulation, Report), Error> {
        self.started = Instant::now();
        let mut triangulation = room;
        self.fetch_into(&mut triangulation)?;
        // Two triangles a point were reckoned with; duplicates have none.
        if triangulation.triangles().len() < triangulation.representatives().len() {
            triangulation.shrink_to_fit();
        }
        let mut bytes = 24 * triangulation.triangles().len() + 4 * triangulation.representatives().len();
        if !triangulation.chains().is_empty() {
            let (offsets, vertices) = (triangulation.chains().offsets(), triangulation.chains().vertices());
            bytes += triangulation.triangles().len() + size_of_val(offsets) + size_of_val(vertices);
        }
        let seconds = self.started.elapsed().as_secs_f64();
        let mut report = self.report;
        let counts = [("bytes", bytes as u64)].into();
        report.stages.push(StageReport { name: "download", on: Place::Transfer, seconds, counts });
        report.seconds += seconds;
        Ok((triangulation, report))
    }
}

/// An empty triangulation with room for one of such an input, which fetching need not wait for.
pub(super) fn room(pslg: &Pslg) -> Triangulation {
    let (points, constraints) = (pslg.points().len(), pslg.constraints().len());
    if points < LARGE {
        return Triangulation::default();
    }
    // Chains of more than two vertices are rare; where there are many, the vertices get room when they come.
    let mut offsets = room_for(constraints + 1);
    offsets.push(0);
    let chains = Chains::from_parts(offsets, room_for(2 * constraints + constraints / 64)).unwrap_or_default();
    let parts = Parts { representatives: room_for(points), chains };
    let made = Triangulation::from_canonical(room_for(2 * points), room_for(2 * points), room_for(2 * points), parts);
    made.unwrap_or_default()
}
