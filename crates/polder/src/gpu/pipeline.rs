//! The kernels of all stages, and how they follow each other.

use super::constraints::Kernels;
use super::held::{Held, Reads};
use super::internal;
use super::work::Input;
use crate::Error;
use crate::plan::flips_first;
use polder_canonical::gpu as canonical;
use polder_constrain::gpu::pieces::Grid;
use polder_constrain::gpu::walk;
use polder_dualize::gpu::{dualize, insert, shift, to_insert};
use polder_flip::gpu::{self as flip, Arithmetic};
use polder_voronoi::gpu as voronoi;
use polder_voronoi::{Bounds, GridMapping};
use polder_vulkan::{Device, Pool, Recording};

#[derive(Debug)]
pub(super) struct Pipeline {
    /// Where stages leave memory that they have done with, for those behind them; and the device, taking from there.
    pub(super) pool: Pool,
    pub(super) device: Device,
    pub(super) bounds: voronoi::FindBounds,
    pub(super) occupancy: voronoi::FindOccupancy,
    pub(super) voronoi: voronoi::Stage,
    pub(super) dualize: dualize::Stage,
    pub(super) shift: shift::Stage,
    pub(super) to_insert: to_insert::Stage,
    pub(super) insert: insert::Stage,
    pub(super) flip: flip::Stage,
    pub(super) canonical: canonical::Stage,
    arithmetic: Arithmetic,
    /// Of constraints, if there were any.
    constraints: Option<Kernels>,
}

impl Pipeline {
    pub(super) fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let (bounds, occupancy) = (voronoi::FindBounds::new(device)?, voronoi::FindOccupancy::new(device)?);
        let pool = Pool::default();
        let device = &device.reusing(&pool);
        Ok(Self {
            pool,
            device: device.clone(),
            bounds,
            occupancy,
            voronoi: voronoi::Stage::new(device)?,
            dualize: dualize::Stage::new(device)?,
            shift: shift::Stage::new(device, arithmetic)?,
            to_insert: to_insert::Stage::new(device)?,
            insert: insert::Stage::with_arithmetic(device, arithmetic)?,
            flip: flip::Stage::with_arithmetic(device, arithmetic)?,
            canonical: canonical::Stage::new(device, arithmetic)?,
            arithmetic,
            constraints: None,
        })
    }

    /// Makes the kernels that constraints need, if they are not there.
    pub(super) fn prepare_constraints(&mut self) -> Result<(), Error> {
        if self.constraints.is_none() {
            self.constraints = Some(Kernels::new(&self.device, self.arithmetic)?);
        }
        Ok(())
    }

    pub(super) fn constraints(&self) -> Result<&Kernels, Error> {
        self.constraints.as_ref().ok_or_else(|| internal("no kernels for constraints"))
    }

    /// Everything from the mapping to the canonical order. Nothing is looked at on the way: a stage that is given nonsense
    /// by the one before does no harm, and the certificate at the end finds what none of them did.
    pub(super) fn record(
        &self,
        recording: &mut Recording,
        (mapping, bounds): (&GridMapping, &Bounds),
        given: &Input<'_>,
        held: &Held,
    ) -> Result<Reads, Error> {
        let (mesh, size, points) = (&held.mesh, &held.needs.size, given.points);
        recording.section("voronoi");
        let voronoi = self.voronoi.record(recording, mapping, points, &held.voronoi)?;
        let (order, pixels, colors) = (held.voronoi.order(), held.voronoi.pixels(), held.voronoi.colors());
        let sites = held.voronoi.site_count()?;

        recording.section("dualize");
        let input = dualize::Input { size: *size, colors, pixels, sites };
        let dualize = self.dualize.record(recording, input, mesh, &held.dualize)?;

        recording.section("shift");
        let input = shift::Input { mapping, points, order, pixels, sites };
        self.flip.record_start(recording, &held.flip);
        held.hull.record_clear(recording);
        let flips = shift::Flips { stage: &self.flip, buffers: &held.flip, tally: &held.hull };
        let shift = self.shift.record(recording, input, mesh, flips, &held.shift)?;
        let hull = held.hull.read(recording);

        recording.section("insert");
        let input = to_insert::Input { width: size[0], colors, pixels, sites };
        self.to_insert.record(recording, input, &held.shift, &held.to_insert)?;
        let input = insert::Input {
            points: held.to_insert.points(),
            starts: held.to_insert.starts(),
            count: Some(held.to_insert.count()?),
            sites,
            freed: held.shift.freed(),
        };
        let insert = self.insert.record(recording, mesh, (&self.flip, &held.flip), &held.insert, input)?;

        let flip_points = flips_first(given.points.len(), given.constraint_count()).then_some(&held.flips_first);
        if let Some(tally) = flip_points {
            recording.section("flip_points");
            tally.record_clear(recording);
            self.flip.record_flip(recording, mesh, &held.flip, tally)?;
        }
        let flip_points = flip_points.map(|tally| tally.read(recording));

        let vertex_of = held.insert.vertex_of();
        let constraints = match (given.constraints, &held.constraints) {
            (Some(constraints), Some(held)) => {
                let names = Some(walk::Names { order, vertex_of });
                let grid = Some(Grid::over(bounds.low(), bounds.high(), points.len()));
                let input = walk::Input { constraints, names, grid };
                Some(self.constraints()?.record(recording, mesh, held, input)?)
            }
            _ => None,
        };

        recording.section("flip");
        held.flips.record_clear(recording);
        self.flip.record_flip(recording, mesh, &held.flip, &held.flips)?;
        let flip = held.flips.read(recording);

        recording.section("canonical_order");
        let chains = held.constraints.as_ref().map(|held| held.to_name()).transpose()?;
        let input = canonical::Input { mesh, vertex_of, order, chains };
        let canonical = self.canonical.record(recording, &input, &held.canonical)?;
        Ok(Reads { voronoi, dualize, shift, hull, insert, flip_points, constraints, flip, canonical })
    }
}
