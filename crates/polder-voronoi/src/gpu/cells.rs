//! How much of their bounding box points on the device fill.

use super::FindBounds;
use crate::kernels::{CountCells, CountCellsArgs, MarkCells, MarkCellsArgs};
use crate::occupancy::{self, EVERY, LEVELS, SIDE};
use crate::{Bounds, Occupancy};
use glam::DVec2;
use polder_vulkan::{Buffer, Device, Error, Kernel, ReadBack, Recording, RunReport, View, groups_for};

const WORKGROUP: u32 = 256;
/// Cells along each side of what a workgroup counts.
const TILE: u32 = 64;

/// Counts the cells that have points, as [`Occupancy::of`] does.
#[derive(Debug)]
pub struct FindOccupancy {
    mark: Kernel<MarkCells>,
    count: Kernel<CountCells>,
    bits: Buffer<u32>,
    counts: Buffer<u32>,
}

impl FindOccupancy {
    /// Compiles the kernels, and holds 512 KiB.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Self {
            mark: Kernel::new(device, &[])?,
            count: Kernel::new(device, &[])?,
            bits: Buffer::new(device, "cells with points", (SIDE * SIDE / 32) as usize)?,
            counts: Buffer::new(device, "occupancy", LEVELS)?,
        })
    }

    /// Appends the work behind that of `bounds`, for the same points. Nothing is appended where points are few.
    pub fn record(&self, recording: &mut Recording, points: View<'_, DVec2>, bounds: &FindBounds) -> OccupancyRead {
        if !occupancy::is_asked_for(points.len()) {
            return OccupancyRead { words: None };
        }
        let (bits, counts) = (self.bits.view(), self.counts.view());
        recording.fill(bits, 0);
        let (count, every) = (points.len() as u32, EVERY);
        let arguments =
            MarkCellsArgs { points: points.cast::<u64>(), bounds: bounds.words(), bits, counts, count, every };
        let runs = points.len().div_ceil(8 * every as usize);
        recording.dispatch(&self.mark, groups_for(8 * runs, WORKGROUP), &arguments);
        let tiles = SIDE / TILE;
        recording.dispatch(&self.count, [tiles, tiles, 1], &CountCellsArgs { bits, counts });
        OccupancyRead { words: Some(recording.read(counts)) }
    }
}

/// Where the counts will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct OccupancyRead {
    words: Option<ReadBack>,
}

impl OccupancyRead {
    /// The occupancy of the box that the same run found; `None` if points are few.
    pub fn occupancy(&self, report: &RunReport, bounds: &Bounds) -> Option<Occupancy> {
        let words = report.words(self.words?);
        Some(Occupancy::of_counts(bounds, std::array::from_fn(|k| words.get(k).copied().unwrap_or(0))))
    }
}
