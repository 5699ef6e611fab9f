//! What a triangulation holds on the device, and what its stages counted.

use super::pipeline::Pipeline;
use crate::Error;
use polder_canonical::gpu as canonical;
use polder_dualize::gpu::{dualize, insert, shift, to_insert};
use polder_flip::FlipReport;
use polder_flip::gpu::{self as flip, Mesh, Tally, TallyRead};
use polder_voronoi::gpu as voronoi;
use polder_vulkan::{Device, Estimate, RunReport};

/// Memory for some number of points, and a grid of some size.
#[derive(Debug)]
pub(super) struct Held {
    pub(super) points: usize,
    pub(super) size: [u32; 2],
    pub(super) voronoi: voronoi::Buffers,
    pub(super) dualize: dualize::Buffers,
    pub(super) shift: shift::Buffers,
    pub(super) to_insert: to_insert::Buffers,
    pub(super) insert: insert::Buffers,
    pub(super) flip: flip::Buffers,
    /// The ghost flips of the shift, and the flips of the last stage.
    pub(super) hull: Tally,
    pub(super) flips: Tally,
    pub(super) mesh: Mesh,
    pub(super) canonical: canonical::Buffers,
}

impl Held {
    /// What stages hold at the same time: none of it may be more than there is.
    fn estimates(pipeline: &Pipeline, points: usize, size: [u32; 2]) -> [Estimate; 4] {
        let slots = Mesh::slots_for(points);
        let voronoi = pipeline.voronoi.estimate(points, size).and(dualize::Stage::estimate(size));
        let flip = || Mesh::estimate(points).and(pipeline.flip.estimate(slots));
        [
            voronoi.and(Mesh::estimate(points)),
            flip().and(shift::Stage::estimate(points)).and(to_insert::Buffers::estimate(points)),
            flip().and(insert::Stage::estimate(points, slots)).and(to_insert::Buffers::estimate(points)),
            Mesh::estimate(points).and(pipeline.canonical.estimate(points, slots)),
        ]
    }

    /// All memory is there before any work is recorded. A stage takes what the ones before have done with: in the order in
    /// which they are recorded, which is the order in which they are made here.
    pub(super) fn new(device: &Device, pipeline: &Pipeline, points: usize, size: [u32; 2]) -> Result<Self, Error> {
        let estimates = Self::estimates(pipeline, points, size);
        estimates.iter().try_for_each(|estimate| estimate.check(device))?;
        let pool = &pipeline.pool;
        pool.clear();
        let mesh = Mesh::new(device, points)?;
        let voronoi = pipeline.voronoi.buffers(points, size)?;
        voronoi.give_scratch(pool);
        let dualize = pipeline.dualize.buffers(size)?;
        let flip = pipeline.flip.buffers(mesh.capacity())?;
        let shift = pipeline.shift.buffers(points)?;
        let to_insert = to_insert::Buffers::new(&pipeline.device, points)?;
        voronoi.give_diagram(pool);
        dualize.give(pool);
        shift.give(pool);
        let insert = pipeline.insert.buffers(points, mesh.capacity())?;
        insert.give(pool);
        shift.give_freed(pool);
        to_insert.give(pool);
        flip.give(pool);
        let canonical = pipeline.canonical.buffers(points, mesh.capacity())?;
        pool.clear();
        let (hull, flips) = (Tally::new(device)?, Tally::new(device)?);
        Ok(Self { points, size, voronoi, dualize, shift, to_insert, insert, flip, hull, flips, mesh, canonical })
    }

    pub(super) fn fits(&self, points: usize, size: [u32; 2]) -> bool {
        (self.points, self.size) == (points, size)
    }
}

/// Where the counts of all stages will be found.
pub(super) struct Reads {
    pub(super) voronoi: voronoi::CountsRead,
    pub(super) dualize: dualize::Read,
    pub(super) shift: shift::Read,
    pub(super) hull: TallyRead,
    pub(super) insert: insert::Read,
    pub(super) flip: TallyRead,
    pub(super) canonical: canonical::CountsRead,
}

/// What the stages counted; none of them found anything wrong.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) voronoi: polder_voronoi::Counts,
    pub(super) dualize: dualize::Counts,
    pub(super) shift: shift::Counts,
    pub(super) hull: FlipReport,
    pub(super) insert: insert::Counts,
    pub(super) flip: FlipReport,
    pub(super) canonical: canonical::Counts,
}

impl Reads {
    /// The counts. If all points lie on one line, those of the stages from insertion on mean nothing.
    ///
    /// # Errors
    ///
    /// What the first stage that found something wrong says.
    pub(super) fn found(&self, report: &RunReport) -> Result<Found, Error> {
        let found = Found {
            voronoi: self.voronoi.counts(report),
            dualize: self.dualize.result(report)?,
            shift: self.shift.result(report)?,
            hull: self.hull.report(report),
            insert: self.insert.result(report)?,
            flip: self.flip.report(report),
            canonical: self.canonical.counts(report),
        };
        if !found.insert.on_a_line {
            found.canonical.verdict()?;
        }
        Ok(found)
    }
}

impl Found {
    /// All points lie on one line, and so many are different.
    pub(super) fn line(&mut self, vertices: u32) {
        (self.canonical.triangles, self.canonical.ghosts, self.canonical.vertices) = (0, 0, vertices);
        (self.insert, self.flip) =
            (insert::Counts { on_a_line: true, ..insert::Counts::default() }, FlipReport::default());
    }

    /// Stages in order, each with what it counted.
    pub(super) fn counts(&self) -> Vec<(&'static str, Vec<(&'static str, u64)>)> {
        let Self { voronoi, dualize, shift, hull, insert, flip, canonical } = self;
        vec![
            ("bounds", vec![]),
            (
                "voronoi",
                vec![
                    ("pixels", voronoi.pixels),
                    ("sites", voronoi.sites),
                    ("missing_points", voronoi.missing),
                    ("debris_pixels", voronoi.debris),
                ],
            ),
            ("dualize", vec![("triangles", dualize.triangles), ("necks", dualize.necks)]),
            (
                "shift",
                vec![
                    ("bad_cases", shift.bad),
                    ("taken_out", shift.taken),
                    ("rounds", shift.rounds.iter().sum()),
                    ("hull_flips", hull.flips),
                ],
            ),
            (
                "insert",
                vec![
                    ("inserted", insert.inserted),
                    ("duplicates", insert.duplicates),
                    ("rounds", insert.rounds),
                    ("flips", insert.flips.flips),
                    ("hull_flips", insert.hull.flips),
                ],
            ),
            ("flip", vec![("rounds", flip.rounds), ("flips", flip.flips), ("tests", flip.tests)]),
            (
                "canonical_order",
                vec![("triangles", canonical.triangles.into()), ("long_lists", canonical.long_lists.into())],
            ),
        ]
    }
}
