//! What a triangulation holds on the device, and what its stages counted.

use super::cut::Cut;
use super::line::OnLine;
use super::pipeline::Pipeline;
use super::{ChainsOnDevice, constraints, internal};
use crate::Error;
use polder_canonical::gpu as canonical;
use polder_constrain::InsertReport;
use polder_dualize::gpu::{dualize, insert, shift, to_insert};
use polder_flip::FlipReport;
use polder_flip::gpu::{self as flip, Mesh, Tally, TallyRead};
use polder_voronoi::gpu as voronoi;
use polder_vulkan::{Device, Estimate, RunReport};

/// What memory depends on: how many points, the size of the grid, constraints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needs {
    pub(super) points: usize,
    pub(super) size: [u32; 2],
    pub(super) constraints: constraints::Needs,
}

/// Memory for an input.
#[derive(Debug)]
pub(super) struct Held {
    pub(super) needs: Needs,
    pub(super) voronoi: voronoi::Buffers,
    pub(super) dualize: dualize::Buffers,
    pub(super) shift: shift::Buffers,
    pub(super) to_insert: to_insert::Buffers,
    pub(super) insert: insert::Buffers,
    /// If there are constraints.
    pub(super) constraints: Option<constraints::Held>,
    pub(super) flip: flip::Buffers,
    /// The ghost flips of the shift, the flips before constraints go in, and those of the last stage.
    pub(super) hull: Tally,
    pub(super) flips_first: Tally,
    pub(super) flips: Tally,
    pub(super) mesh: Mesh,
    pub(super) canonical: canonical::Buffers,
    /// What the last call left, if its points were on a line and had constraints.
    pub(super) on_line: Option<OnLine>,
    /// What the last call left, if its constraints were cut.
    pub(super) cut: Option<Cut>,
}

impl Held {
    /// What stages hold at the same time: none of it may be more than there is.
    fn estimates(pipeline: &Pipeline, needs: Needs) -> [Estimate; 5] {
        let Needs { points, size, constraints } = needs;
        let slots = Mesh::slots_for(points);
        let voronoi = pipeline.voronoi.estimate(points, size).and(dualize::Stage::estimate(size));
        let flip = || Mesh::estimate(points).and(pipeline.flip.estimate(slots));
        [
            voronoi.and(Mesh::estimate(points)),
            flip().and(shift::Stage::estimate(points)).and(to_insert::Buffers::estimate(points)),
            flip().and(insert::Stage::estimate(points, slots)).and(to_insert::Buffers::estimate(points)),
            flip().and(constraints.estimate(points, slots)),
            Mesh::estimate(points).and(pipeline.canonical.estimate(points, slots)),
        ]
    }

    /// All memory is there before any work is recorded. A stage takes what the ones before have done with: in the order in
    /// which they are recorded, which is the order in which they are made here.
    pub(super) fn new(device: &Device, pipeline: &Pipeline, needs: Needs) -> Result<Self, Error> {
        let Needs { points, size, .. } = needs;
        let estimates = Self::estimates(pipeline, needs);
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
        let constraints = match needs.constraints.constraints {
            0 => None,
            _ => Some(constraints::Held::new(pipeline.constraints()?, needs.constraints, &mesh, pool)?),
        };
        flip.give(pool);
        let canonical = pipeline.canonical.buffers(points, mesh.capacity())?;
        pool.clear();
        let [hull, flips_first, flips] = [Tally::new(device)?, Tally::new(device)?, Tally::new(device)?];
        Ok(Self {
            needs,
            voronoi,
            dualize,
            shift,
            to_insert,
            insert,
            constraints,
            flip,
            hull,
            flips_first,
            flips,
            mesh,
            canonical,
            on_line: None,
            cut: None,
        })
    }

    /// The vertices along constraints, if there are any.
    pub(super) fn chains(&self, found: &Found) -> Result<Option<ChainsOnDevice<'_>>, Error> {
        if let Some(cut) = &self.cut {
            return Ok(Some(cut.chains()));
        }
        match (&found.chains, &self.on_line, &self.constraints) {
            (None, ..) => Ok(None),
            (_, Some(on_line), _) => Ok(Some(on_line.chains())),
            (Some(found), None, Some(held)) => Ok(Some(held.chains(found)?)),
            _ => Err(internal("chains of no constraints")),
        }
    }

    pub(super) fn fits(&self, needs: &Needs) -> bool {
        let Needs { points, size, constraints } = &self.needs;
        (*points, *size) == (needs.points, needs.size) && constraints.cover(&needs.constraints)
    }
}

/// Where the counts of all stages will be found.
pub(super) struct Reads {
    pub(super) voronoi: voronoi::CountsRead,
    pub(super) dualize: dualize::Read,
    pub(super) shift: shift::Read,
    pub(super) hull: TallyRead,
    pub(super) insert: insert::Read,
    pub(super) constraints: Option<constraints::Reads>,
    /// Where the points are flipped before constraints go in.
    pub(super) flip_points: Option<TallyRead>,
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
    pub(super) flip_points: Option<FlipReport>,
    pub(super) flip: FlipReport,
    pub(super) canonical: canonical::Counts,
    /// If there were constraints.
    pub(super) chains: Option<constraints::Found>,
}

impl Reads {
    /// Room for how many vertices between the ends of constraints would have been needed, if there was not enough.
    pub(super) fn more_stops(&self, report: &RunReport) -> Option<usize> {
        let on_a_line = self.insert.result(report).is_ok_and(|counts| counts.on_a_line);
        self.constraints.as_ref().filter(|_| !on_a_line)?.more_stops(report)
    }

    /// The counts. If all points lie on one line, those of the stages from insertion on mean nothing.
    ///
    /// # Errors
    ///
    /// What the first stage that found something wrong says.
    pub(super) fn found(&self, report: &RunReport) -> Result<Found, Error> {
        let mut found = Found {
            voronoi: self.voronoi.counts(report),
            dualize: self.dualize.result(report)?,
            shift: self.shift.result(report)?,
            hull: self.hull.report(report),
            insert: self.insert.result(report)?,
            flip_points: self.flip_points.as_ref().map(|read| read.report(report)),
            flip: self.flip.report(report),
            canonical: self.canonical.counts(report),
            chains: None,
        };
        if !found.insert.on_a_line {
            // First: where constraints were not all inserted, what follows stood before no finished work.
            found.chains = self.constraints.as_ref().map(|reads| reads.found(report)).transpose()?;
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

    /// The chains of so many constraints on that line have so many vertices; so many of them more than two.
    pub(super) fn line_chains(&mut self, constraints: usize, vertices: u64, through: u32) {
        let pieces = vertices - constraints as u64;
        self.chains = Some(constraints::Found { pieces, vertices, insertion: InsertReport::default() });
        (self.canonical.through_vertices, self.canonical.constrained_edges) = (through, 0);
    }

    /// Stages in order, each with what it counted.
    pub(super) fn counts(&self) -> Vec<(&'static str, Vec<(&'static str, u64)>)> {
        let Self { voronoi, dualize, shift, hull, insert, flip_points, flip, canonical, chains } = self;
        let flips = |flip: &FlipReport| vec![("rounds", flip.rounds), ("flips", flip.flips), ("tests", flip.tests)];
        let mut stages = vec![
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
        ];
        stages.extend(flip_points.iter().map(|report| ("flip_points", flips(report))));
        stages.extend(chains.iter().flat_map(constraints::Found::counts));
        stages.extend([
            ("flip", flips(flip)),
            (
                "canonical_order",
                vec![("triangles", canonical.triangles.into()), ("long_lists", canonical.long_lists.into())],
            ),
        ]);
        stages
    }
}
