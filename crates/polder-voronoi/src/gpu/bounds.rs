//! The bounding box of points that lie on the device.

use super::buffers::MOST_POINTS;
use crate::kernels::{BoundPartials, BoundPartialsArgs, BoundPoints, BoundPointsArgs};
use crate::{Bounds, VoronoiError};
use glam::DVec2;
use polder_vulkan::{Buffer, Device, Error, Kernel, ReadBack, Recording, RunReport, View};

const WORKGROUP: usize = 256;
/// Workgroups of the first kernel.
const GROUPS: usize = 1024;
/// Points that an invocation takes at least, where there are enough.
const EACH: usize = 4;
/// Numbers of a box.
const NUMBERS: usize = 5;

/// Finds the bounding box of points, exactly, and the first coordinate that is not finite.
#[derive(Debug)]
pub struct FindBounds {
    points: Kernel<BoundPoints>,
    partials: Kernel<BoundPartials>,
    partial: Buffer<u64>,
    bounds: Buffer<u64>,
}

impl FindBounds {
    /// Compiles the kernels, and holds a few KiB.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Self {
            points: Kernel::new(device, &[])?,
            partials: Kernel::new(device, &[])?,
            partial: Buffer::new(device, "bounds of workgroups", NUMBERS * GROUPS)?,
            bounds: Buffer::new(device, "bounds", NUMBERS)?,
        })
    }

    /// Appends the work; the box comes with the report.
    ///
    /// # Errors
    ///
    /// If there are more than 2^28 points, as many as the stage takes.
    pub fn record(&self, recording: &mut Recording, points: View<'_, DVec2>) -> Result<BoundsRead, Error> {
        if points.len() > MOST_POINTS {
            let why = format!("{} points; at most {MOST_POINTS} are possible", points.len());
            return Err(Error::Recording { command: "bound_points", why });
        }
        let count = points.len() as u32;
        let groups = points.len().div_ceil(WORKGROUP * EACH).clamp(1, GROUPS);
        let (partial, bounds) = (self.partial.view(), self.bounds.view());
        let arguments = BoundPointsArgs { points: points.cast::<[u32; 4]>(), partial, count };
        recording.dispatch(&self.points, [groups as u32, 1, 1], &arguments);
        let arguments = BoundPartialsArgs { partial, bounds, count: groups as u32 };
        recording.dispatch(&self.partials, [1, 1, 1], &arguments);
        Ok(BoundsRead { words: recording.read(bounds.cast::<u32>()) })
    }
}

impl FindBounds {
    /// The box on the device, as five ordered numbers.
    pub(super) fn words(&self) -> View<'_, u64> {
        self.bounds.view()
    }
}

/// Where the box will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct BoundsRead {
    words: ReadBack,
}

impl BoundsRead {
    /// The box.
    ///
    /// # Errors
    ///
    /// If there were no points, or a coordinate is not finite: the first such point.
    pub fn bounds(&self, report: &RunReport) -> Result<Bounds, VoronoiError> {
        let words = report.words(self.words);
        let number = |k: usize| match words.get(2 * k..2 * k + 2) {
            Some(&[low, high]) => u64::from(high) << 32 | u64::from(low),
            _ => u64::MAX,
        };
        Bounds::of_words([0, 1, 2, 3, 4].map(number))
    }
}
