//! The stages that constraints take: kernels, made when there are constraints for the first time; memory; counts.

use super::ChainsOnDevice;
use super::work::crossings_met;
use crate::Error;
use polder_canonical::gpu as canonical;
use polder_constrain::gpu::{insert, walk};
use polder_constrain::reference::MOST_SUB_CONSTRAINTS;
use polder_constrain::{ConstrainError, Fault, InsertReport};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_vulkan::{Device, Estimate, Pool, Recording, RunReport, View};

/// Kernels reach 4 GiB from an address: of so many constraints, and of so many vertices between their ends, all lists fit.
const MOST_CONSTRAINTS: usize = 1 << 27;
const MOST_STOPS: usize = u32::MAX as usize / 12;

/// The kernels.
#[derive(Debug)]
pub(super) struct Kernels {
    walk: walk::Stage,
    insert: insert::Stage,
}

impl Kernels {
    /// `device` takes memory from the stages before.
    pub(super) fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let walk = walk::Stage::with_arithmetic(device, arithmetic)?;
        let insert = insert::Stage::with_arithmetic(device, arithmetic)?;
        device.compile()?;
        Ok(Self { walk, insert })
    }

    /// Constraints become edges of a mesh.
    pub(super) fn record(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        held: &Held,
        input: walk::Input<'_>,
    ) -> Result<Reads, Error> {
        recording.section("walk");
        let walk = self.walk.record(recording, mesh, &held.walk, input)?;
        recording.section("constrain");
        let sub_constraints = held.sub_constraints()?;
        let (spokes, degrees) = (held.walk.spokes(), held.walk.degrees());
        let count = Some(held.walk.sub_constraint_count()?);
        let pieces = input.grid.map(|grid| (grid, held.walk.pieces()));
        let input = insert::Input { sub_constraints, count, spokes, degrees, pieces };
        let insert = self.insert.record(recording, mesh, &held.insert, input)?;
        Ok(Reads { walk, insert })
    }
}

/// How many constraints, and vertices between their ends: what memory depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Needs {
    pub(super) constraints: usize,
    pub(super) stops: usize,
}

impl Needs {
    pub(super) fn usual(constraints: usize) -> Self {
        let stops = if constraints == 0 { 0 } else { walk::Stage::usual_stops(constraints) };
        Self { constraints, stops }
    }

    /// Whether memory for these is enough for others.
    pub(super) fn cover(&self, other: &Self) -> bool {
        self.constraints == other.constraints && self.stops >= other.stops
    }

    /// Whether a device can do it.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`].
    pub(super) fn check(&self) -> Result<(), Error> {
        let Self { constraints, stops } = *self;
        let sizes = [
            (constraints, MOST_CONSTRAINTS, "constraints"),
            (stops, MOST_STOPS, "vertices that constraints run through"),
        ];
        match sizes.into_iter().find(|(count, most, _)| count > most) {
            Some((count, most, what)) => Err(too_many(count, most, what)),
            None => Ok(()),
        }
    }

    pub(super) fn estimate(&self, points: usize, slots: usize) -> Estimate {
        if self.constraints == 0 {
            return Estimate::new();
        }
        let walk = walk::Stage::estimate(points, self.constraints, self.stops);
        let pieces = walk::Stage::pieces(self.constraints);
        let sub_constraints = (self.constraints + self.stops).min(MOST_SUB_CONSTRAINTS);
        walk.and(insert::Stage::estimate(sub_constraints, pieces, slots))
    }
}

/// Memory.
#[derive(Debug)]
pub(super) struct Held {
    walk: walk::Buffers,
    insert: insert::Buffers,
}

impl Held {
    pub(super) fn new(kernels: &Kernels, needs: Needs, mesh: &Mesh, pool: &Pool) -> Result<Self, Error> {
        let points = mesh.vertices();
        let walk = kernels.walk.buffers(points, needs.constraints, needs.stops)?;
        walk.give(pool);
        let pieces = walk.pieces().pieces().len();
        let sub_constraints = walk.sub_constraints().len().min(MOST_SUB_CONSTRAINTS);
        let insert = kernels.insert.buffers(sub_constraints, pieces, mesh.capacity())?;
        insert.give(pool);
        Ok(Self { walk, insert })
    }

    /// All that may be inserted.
    fn sub_constraints(&self) -> Result<View<'_, [u32; 2]>, Error> {
        let all = self.walk.sub_constraints();
        Ok(all.slice(0..all.len().min(MOST_SUB_CONSTRAINTS))?)
    }

    /// The vertices along constraints, to be given their names.
    pub(super) fn to_name(&self) -> Result<canonical::Chains<'_>, Error> {
        let count = Some(self.walk.chained()?);
        Ok(canonical::Chains { starts: self.walk.offsets()?, vertices: self.walk.chains(), count })
    }

    pub(super) fn chains(&self, found: &Found) -> Result<ChainsOnDevice<'_>, Error> {
        let vertices = self.walk.chains().slice(0..found.vertices as usize)?;
        Ok(ChainsOnDevice { offsets: self.walk.offsets()?, vertices })
    }
}

/// Where the counts will be found.
pub(super) struct Reads {
    walk: walk::Read,
    insert: insert::Read,
}

/// What became of constraints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Pieces of constraints from vertex to vertex, repeated ones each time, and vertices of all chains.
    pub(super) pieces: u64,
    pub(super) vertices: u64,
    pub(super) insertion: InsertReport,
}

impl Reads {
    /// Room for how many vertices between ends would have been needed, if there was not enough.
    pub(super) fn more_stops(&self, report: &RunReport) -> Option<usize> {
        match self.walk.result(report) {
            Err(ConstrainError::TooManyStops { needed, .. }) => Some(needed as usize),
            _ => None,
        }
    }

    /// What the stages counted.
    ///
    /// # Errors
    ///
    /// [`crossings_met`]; all else is a defect.
    pub(super) fn found(&self, report: &RunReport) -> Result<Found, Error> {
        let walk = self.walk.result(report)?;
        let pieces = walk.sub_constraints as usize;
        if pieces > MOST_SUB_CONSTRAINTS {
            return Err(too_many(pieces, MOST_SUB_CONSTRAINTS, "pieces of constraints"));
        }
        let insert = self.insert.counts(report);
        let internal = |what: String| Err(Error::Internal { stage: "constrain", what });
        match insert.fault {
            Some(Fault::Blocked(_)) => return Err(crossings_met()),
            Some(Fault::Stuck) => {
                return Err(Error::BoundExceeded { stage: "constrain", bound: insert.report.outer_rounds });
            }
            Some(Fault::ThroughVertex(s)) => return internal(format!("piece {s} runs through a vertex")),
            Some(Fault::Lost(s)) => return internal(format!("piece {s} lost its way")),
            None => {}
        }
        if insert.inserted != walk.sub_constraints {
            return internal(format!("{} of {} pieces were inserted", insert.inserted, walk.sub_constraints));
        }
        Ok(Found { pieces: walk.sub_constraints, vertices: walk.chained, insertion: insert.report })
    }
}

fn too_many(count: usize, most: usize, what: &str) -> Error {
    Error::Unsupported { what: format!("{count} {what}: a device takes {most} at most, the backend cpu more") }
}

impl Found {
    /// Both stages, each with what it counted.
    pub(super) fn counts(&self) -> [(&'static str, Vec<(&'static str, u64)>); 2] {
        let Self { pieces, vertices, insertion } = self;
        let intersections = insertion.intersections.map(|intersections| ("intersections", intersections));
        let constrain = [
            ("pieces", insertion.sub_constraints),
            ("edges_already", insertion.edges_already),
            ("rounds", insertion.inner_rounds),
            ("outer_rounds", insertion.outer_rounds),
            ("rebuilt", insertion.rebuilt),
            ("flips", insertion.all_flips()),
        ];
        let constrain = constrain.into_iter().chain(intersections).collect();
        [("walk", vec![("pieces", *pieces), ("chain_vertices", *vertices)]), ("constrain", constrain)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_kernels_do_not_reach_is_refused() {
        assert_eq!(Needs::usual(0).check(), Ok(()));
        assert_eq!(Needs::usual(MOST_CONSTRAINTS).check(), Ok(()));
        let stops = MOST_STOPS + 1;
        for needs in [Needs::usual(MOST_CONSTRAINTS + 1), Needs { constraints: 1, stops }] {
            assert!(needs.check().is_err_and(|error| error.kind() == "unsupported"));
        }
    }
}
