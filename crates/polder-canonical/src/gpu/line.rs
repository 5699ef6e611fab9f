//! Points on one line, on the device: their duplicates. See [`reference::line`](crate::reference::line()).

use super::WORKGROUP;
use crate::kernels::{
    LineChainsArgs, LineHeads, LineHeadsArgs, LineKeys, LineKeysArgs, LineLengths, LineLengthsArgs, LineNames,
    LineNamesArgs, LinePlaces, LinePlacesArgs,
};
use crate::reference::Axis;
use glam::DVec2;
use polder_vulkan::primitives::{Compact, Scan, Sort};
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, ReadBack, Recording, RunReport, View, groups_for};

/// Kernels and memory for points on a line; made when there are some.
#[derive(Debug)]
pub struct Line {
    keys_kernel: Kernel<LineKeys>,
    heads_kernel: Kernel<LineHeads>,
    names_kernel: Kernel<LineNames>,
    keys: Buffer<u64>,
    values: Buffer<u32>,
    flags: Buffer<u32>,
    ranks: Buffer<u32>,
    heads: Buffer<u32>,
    count: Buffer<u32>,
    sort: Sort<u64>,
    scan: Scan,
    compact: Compact,
}

/// Where the number of different points will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct LineRead(ReadBack);

impl LineRead {
    /// How many different points there are.
    pub fn vertices(&self, report: &RunReport) -> u32 {
        report.word(self.0)
    }
}

impl Line {
    /// What [`Line::new`] will hold.
    pub fn estimate(device: &Device, points: usize) -> Estimate {
        let mut estimate = Estimate::new().buffer::<u64>("keys of points", points).buffer::<u32>("runs", 4);
        for name in ["points on the line", "beginnings of runs", "runs before", "first of runs"] {
            estimate = estimate.buffer::<u32>(name, points);
        }
        let primitives = Scan::estimate(points).and(Compact::estimate(points));
        estimate.and(Sort::<u64>::estimate(device, points)).and(primitives)
    }

    /// For so many points.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn new(device: &Device, points: usize) -> Result<Self, Error> {
        Self::estimate(device, points).check(device)?;
        let words = |name| Buffer::<u32>::new(device, name, points);
        Ok(Self {
            keys_kernel: Kernel::new(device, &[])?,
            heads_kernel: Kernel::new(device, &[])?,
            names_kernel: Kernel::new(device, &[])?,
            keys: Buffer::new(device, "keys of points", points)?,
            values: words("points on the line")?,
            flags: words("beginnings of runs")?,
            ranks: words("runs before")?,
            heads: words("first of runs")?,
            count: Buffer::new(device, "runs", 4)?,
            sort: Sort::new(device, points)?,
            scan: Scan::new(device, points)?,
            compact: Compact::new(device, points)?,
        })
    }

    /// Writes for each point the lowest index of the points equal to it.
    ///
    /// # Errors
    ///
    /// If it was made for another number of points.
    pub fn record(
        &self,
        recording: &mut Recording,
        points: View<'_, DVec2>,
        axis: Axis,
        representatives: View<'_, u32>,
    ) -> Result<LineRead, Error> {
        let length = self.values.len();
        if points.len() != length || representatives.len() < length {
            let why = format!("{} points; made for {length}", points.len());
            return Err(Error::Recording { command: "line", why });
        }
        let (keys, values, flags) = (self.keys.view(), self.values.view(), self.flags.view());
        let (ranks, heads, total) = (self.ranks.view(), self.heads.view(), self.count.slice(0..1)?);
        let (groups, count) = (groups_for(length, WORKGROUP), length as u32);
        let arguments = LineKeysArgs { points: points.cast(), keys, values, axis: axis as u32, count };
        recording.dispatch(&self.keys_kernel, groups, &arguments);
        self.sort.record(recording, length, keys, Some(values), u64::BITS);
        recording.dispatch(&self.heads_kernel, groups, &LineHeadsArgs { keys, flags, count });
        self.scan.record(recording, length, flags, ranks, None);
        self.compact.record(recording, length, flags, Some(values), heads, total);
        let arguments = LineNamesArgs { values, flags, ranks, heads, representatives, count };
        recording.dispatch(&self.names_kernel, groups, &arguments);
        Ok(LineRead(recording.read(total)))
    }
}

/// Vertices that one dispatch writes: kernels reach 4 GiB.
const PIECE: usize = 1 << 28;
/// Words of the totals: the sum of all lengths in two, then how many chains pass through vertices.
const TOTALS: usize = 4;

/// Kernels and memory for constraints among points on a line.
#[derive(Debug)]
pub struct LineChains {
    places_kernel: Kernel<LinePlaces>,
    lengths_kernel: Kernel<LineLengths>,
    chains_kernel: Kernel<crate::kernels::LineChains>,
    places: Buffer<u32>,
    starts: Buffer<u32>,
    totals: Buffer<u32>,
    scan: Scan,
}

/// Where the number of vertices in all chains will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct LineChainsRead(ReadBack);

impl LineChainsRead {
    /// How many vertices all chains have.
    pub fn vertices(&self, report: &RunReport) -> u64 {
        match *report.words(self.0) {
            [low, high, ..] => u64::from(high) << 32 | u64::from(low),
            _ => 0,
        }
    }

    /// How many chains have a vertex between their ends.
    pub fn through_vertices(&self, report: &RunReport) -> u32 {
        report.words(self.0).get(2).copied().unwrap_or(0)
    }
}

impl LineChains {
    /// What [`LineChains::new`] will hold.
    pub fn estimate(points: usize, constraints: usize) -> Estimate {
        let estimate = Estimate::new().buffer::<u32>("places on the line", points).buffer::<u32>("totals", TOTALS);
        estimate.buffer::<u32>("starts of chains", constraints + 1).and(Scan::estimate(constraints + 1))
    }

    /// For so many points and constraints.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn new(device: &Device, points: usize, constraints: usize) -> Result<Self, Error> {
        Self::estimate(points, constraints).check(device)?;
        Ok(Self {
            places_kernel: Kernel::new(device, &[])?,
            lengths_kernel: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            chains_kernel: Kernel::new(device, &[])?,
            places: Buffer::new(device, "places on the line", points)?,
            starts: Buffer::new(device, "starts of chains", constraints + 1)?,
            totals: Buffer::new(device, "totals", TOTALS)?,
            scan: Scan::new(device, constraints + 1)?,
        })
    }

    /// Where the chain of each constraint begins, and where the last one ends: nonsense if there are 2³² vertices or more.
    pub fn starts(&self) -> View<'_, u32> {
        self.starts.view()
    }

    /// First half: counts the vertices along each constraint, behind [`Line::record`]. `ends` are input points.
    ///
    /// # Errors
    ///
    /// If it was made for other numbers of points or constraints.
    pub fn record_starts(
        &self,
        recording: &mut Recording,
        line: &Line,
        ends: View<'_, [u32; 2]>,
    ) -> Result<LineChainsRead, Error> {
        self.check(line, ends)?;
        let (places, starts, totals) = (self.places.view(), self.starts.view(), self.totals.view());
        let (values, flags, ranks) = (line.values.view(), line.flags.view(), line.ranks.view());
        let (points, constraints) = (values.len(), ends.len());
        let count = points as u32;
        recording.fill(starts, 0);
        recording.fill(totals, 0);
        let arguments = LinePlacesArgs { values, flags, ranks, places, count };
        recording.dispatch(&self.places_kernel, groups_for(points, WORKGROUP), &arguments);
        let arguments = LineLengthsArgs {
            ends: ends.cast(),
            places,
            lengths: starts,
            totals,
            constraints: constraints as u32,
            count,
        };
        recording.dispatch(&self.lengths_kernel, groups_for(constraints, WORKGROUP), &arguments);
        self.scan.record(recording, constraints + 1, starts, starts, None);
        Ok(LineChainsRead(recording.read(totals)))
    }

    /// Second half: writes the chains, as many vertices as the first half counted.
    ///
    /// # Errors
    ///
    /// If it was made for other numbers of points or constraints.
    pub fn record_chains(
        &self,
        recording: &mut Recording,
        line: &Line,
        ends: View<'_, [u32; 2]>,
        chains: View<'_, u32>,
    ) -> Result<(), Error> {
        self.check(line, ends)?;
        for first in (0..chains.len()).step_by(PIECE) {
            let part = chains.slice(first..chains.len().min(first + PIECE))?;
            let arguments = LineChainsArgs {
                ends: ends.cast(),
                places: self.places.view(),
                starts: self.starts.view(),
                heads: line.heads.view(),
                chains: part,
                constraints: ends.len() as u32,
                first: first as u32,
                limit: part.len() as u32,
            };
            recording.dispatch(&self.chains_kernel, groups_for(part.len(), WORKGROUP), &arguments);
        }
        Ok(())
    }

    fn check(&self, line: &Line, ends: View<'_, [u32; 2]>) -> Result<(), Error> {
        let (points, constraints) = (self.places.len(), self.starts.len() - 1);
        if line.values.len() == points && ends.len() == constraints {
            return Ok(());
        }
        let why =
            format!("{} points and {} constraints; made for {points} and {constraints}", line.values.len(), ends.len());
        Err(Error::Recording { command: "line chains", why })
    }
}
