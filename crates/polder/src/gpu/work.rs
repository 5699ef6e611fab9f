//! One triangulation, from points and constraints on the device to a result there.

use super::held::{Found, Held, Needs};
use super::{Gpu, constraints, internal, line};
use crate::report::Stopwatch;
use crate::{Error, Options, Report};
use polder_mesh::{DVec2, MeshError, Progress, Pslg};
use polder_voronoi::{Bounds, GridMapping, Occupancy, Resolution};
use polder_vulkan::primitives::{Operation, Reduce};
use polder_vulkan::{Buffer, Engine, Recording, RunOptions, RunReport, View};
use std::sync::atomic::Ordering;

/// How often more memory is made for vertices that constraints run through: how many there are is known after one run.
const ATTEMPTS: u32 = 2;

/// Points and constraints in the device's memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input<'a> {
    pub(super) points: View<'a, DVec2>,
    /// Pairs of points; none are no constraints.
    pub(super) constraints: Option<View<'a, [u32; 2]>>,
    /// Whether the constraints are known to name points that exist.
    pub(super) checked: bool,
}

impl Input<'_> {
    pub(super) fn constraint_count(&self) -> usize {
        self.constraints.map_or(0, |view| view.len())
    }

    /// The same in the host's memory.
    pub(super) fn download(&self, engine: &mut Engine) -> Result<Pslg, Error> {
        let points = engine.download_vec(self.points)?;
        let constraints = self.constraints.map(|view| engine.download_vec(view)).transpose()?.unwrap_or_default();
        Ok(Pslg::new(points, constraints)?)
    }
}

/// What stands for crossings that were met and not named yet; also their name where none is asked for.
pub(super) fn crossings_met() -> Error {
    Error::CrossingConstraints { pairs: Vec::new(), truncated: true }
}

impl Gpu {
    /// Triangulates. The result lies in what is held, if there was a point. Constraints that cross are an error that does not
    /// name them.
    pub(super) fn work(
        &mut self,
        input: Input<'_>,
        options: &Options,
        mut watch: Stopwatch,
    ) -> Result<(Option<Found>, Report), Error> {
        let points = input.points.len();
        if points == 0 && input.constraint_count() == 0 {
            self.held = None;
            return Ok((None, self.report(watch, (0, 0), None, &[])));
        }
        let mut runs = Vec::new();
        let (bounds, occupancy) = self.bounds(&input, options, &mut runs)?;
        let resolution = match options.grid {
            Some(side) => Resolution::LongerSide(side).into(),
            None => polder_voronoi::Options::default(),
        };
        let mapping = GridMapping::fit_bounds(&bounds, occupancy.as_ref(), points, &resolution)?;
        let constraints = constraints::Needs::usual(input.constraint_count());
        let mut needs = Needs { points, size: mapping.size(), constraints };
        if input.constraints.is_some() {
            self.pipeline.prepare_constraints()?;
        }
        watch.skip();
        let mut attempts = 0..ATTEMPTS;
        let mut found = loop {
            self.make_room(needs)?;
            let held = self.held.as_mut().ok_or_else(|| internal("no memory was made"))?;
            (held.on_line, held.cut) = (None, None);
            let mut recording = Recording::new(&self.device);
            let reads = self.pipeline.record(&mut recording, (&mapping, &bounds), &input, held)?;
            let report = run(&mut self.engine, &recording, options)?;
            let more_stops = reads.more_stops(&report);
            let found = reads.found(&report);
            runs.push(report);
            match more_stops.filter(|_| attempts.next().is_some()) {
                Some(stops) => needs.constraints.stops = stops,
                None => break found?,
            }
        };
        let held = self.held.as_mut().ok_or_else(|| internal("no memory was made"))?;
        if found.insert.on_a_line {
            line::finish((&self.device, &mut self.engine), &input, &bounds, held, &mut found, options, &mut runs)?;
        }
        watch.skip();
        let report = self.report(watch, (points, input.constraint_count()), Some(&found), &runs);
        Ok((Some(found), report))
    }

    /// The box around the points, and how much of it they fill. Constraints that are not known to name points are looked at on the same occasion.
    fn bounds(
        &mut self,
        input: &Input<'_>,
        options: &Options,
        runs: &mut Vec<RunReport>,
    ) -> Result<(Bounds, Option<Occupancy>), Error> {
        let points = input.points.len();
        let mut recording = Recording::new(&self.device);
        recording.section("bounds");
        let read = match points {
            0 => None,
            _ => Some(self.pipeline.bounds.record(&mut recording, input.points)?),
        };
        // Of no use where the caller says how fine the grid shall be.
        let cells = (points > 0 && options.grid.is_none())
            .then(|| self.pipeline.occupancy.record(&mut recording, input.points, &self.pipeline.bounds));
        let looked = match input.constraints.filter(|_| !input.checked) {
            Some(constraints) => {
                let highest = Buffer::<u32>::new(&self.device, "highest index", 1)?;
                let reduce = Reduce::<u32>::new(&self.device, Operation::Maximum)?;
                let ends = constraints.cast::<u32>();
                reduce.record(&mut recording, ends.len(), ends, highest.view());
                Some((recording.read(highest.view()), constraints))
            }
            None => None,
        };
        let report = run(&mut self.engine, &recording, options)?;
        let bounds = read.map(|read| read.bounds(&report)).transpose()?;
        if let Some((highest, constraints)) = looked
            && report.word(highest) as usize >= points
        {
            let constraints = self.engine.download_vec(constraints)?;
            return Err(out_of_range(&constraints, points));
        }
        runs.push(report);
        let bounds = bounds.ok_or_else(|| internal("constraints among no points"))?;
        let occupancy = runs.last().zip(cells).and_then(|(report, cells)| cells.occupancy(report, &bounds));
        Ok((bounds, occupancy))
    }

    /// Memory for such an input; nothing is done if that is what there is.
    fn make_room(&mut self, needs: Needs) -> Result<(), Error> {
        needs.constraints.check()?;
        if self.held.as_ref().is_none_or(|held| !held.fits(&needs)) {
            self.held = None;
            self.held = Some(Held::new(&self.device, &self.pipeline, needs)?);
        }
        Ok(())
    }
}

/// The first constraint that names a point that does not exist.
fn out_of_range(constraints: &[[u32; 2]], points: usize) -> Error {
    let bad = |(constraint, ends): (usize, &[u32; 2])| {
        let index = ends.iter().copied().find(|&index| index as usize >= points)?;
        Some(MeshError::IndexOutOfRange { constraint, index, points }.into())
    };
    let found = constraints.iter().enumerate().find_map(bad);
    found.unwrap_or_else(|| internal("constraints changed meanwhile"))
}

/// Runs a recording as the options say.
pub(super) fn run(engine: &mut Engine, recording: &Recording, options: &Options) -> Result<RunReport, Error> {
    let cancel = || options.cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
    let tell = |stage: &'static str, rounds: u32| {
        if let Some(progress) = &options.progress {
            progress(Progress { stage, done: rounds.into(), total: rounds.into() });
        }
    };
    if cancel() {
        return Err(polder_vulkan::Error::Cancelled.into());
    }
    let run_options = RunOptions {
        timestamps: options.timestamps,
        cancel: Some(&cancel),
        progress: Some(&tell),
        ..RunOptions::default()
    };
    Ok(engine.run(recording, &run_options)?)
}
