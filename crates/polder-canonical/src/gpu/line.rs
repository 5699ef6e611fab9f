//! Points on one line, on the device: their duplicates. See [`reference::line`](crate::reference::line()).

use super::WORKGROUP;
use crate::kernels::{LineHeads, LineHeadsArgs, LineKeys, LineKeysArgs, LineNames, LineNamesArgs};
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
