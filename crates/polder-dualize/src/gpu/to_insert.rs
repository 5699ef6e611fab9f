//! Between stages 3 and 4: the points that the mesh lacks, and where to look for each.

use super::shift;
use crate::kernels::{PointsToInsert, PointsToInsertArgs};
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, Pool, Recording, View, groups_for};

const WORKGROUP: u32 = 256;

/// What the step takes: a diagram and its sites, on the device.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The width of the grid.
    pub width: u32,
    /// The site of each pixel, row by row.
    pub colors: View<'a, u32>,
    /// The pixel of each point in the new order, sites first.
    pub pixels: View<'a, [u16; 2]>,
    /// How many sites there are.
    pub sites: View<'a, u32>,
}

/// Lists for some number of points.
#[derive(Debug)]
pub struct Buffers {
    points: Buffer<u32>,
    starts: Buffer<u32>,
    count: Buffer<u32>,
}

impl Buffers {
    /// What [`Buffers::new`] will hold.
    pub fn estimate(points: usize) -> Estimate {
        Estimate::new()
            .buffer::<u32>("points to insert", points)
            .buffer::<u32>("starts", points)
            .buffer::<u32>("points to insert, count", 4)
    }

    /// Memory for as many points as there are.
    ///
    /// # Errors
    ///
    /// If it cannot be had.
    pub fn new(device: &Device, points: usize) -> Result<Self, Error> {
        Ok(Self {
            points: Buffer::new(device, "points to insert", points)?,
            starts: Buffer::new(device, "starts", points)?,
            count: Buffer::new(device, "points to insert, count", 4)?,
        })
    }

    /// Gives the lists; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.points.give(pool);
        self.starts.give(pool);
    }

    /// The points, by the number of the new order; in any order.
    pub fn points(&self) -> View<'_, u32> {
        self.points.view()
    }

    /// For each a vertex from which the search for it starts, or [`polder_mesh::NONE`].
    pub fn starts(&self) -> View<'_, u32> {
        self.starts.view()
    }

    /// How many there are.
    ///
    /// # Errors
    ///
    /// None.
    pub fn count(&self) -> Result<View<'_, u32>, Error> {
        self.count.slice(0..1)
    }
}

/// The kernel of the step.
#[derive(Debug)]
pub struct Stage {
    kernel: Kernel<PointsToInsert>,
}

impl Stage {
    /// Compiles it.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Self { kernel: Kernel::new(device, &[])? })
    }

    /// Lists what [`reference::points_to_insert`](crate::reference::points_to_insert) does, but for its order and the slots.
    ///
    /// # Errors
    ///
    /// If the buffers are for another number of points.
    pub fn record(
        &self,
        recording: &mut Recording,
        input: Input<'_>,
        shifted: &shift::Buffers,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        let limit = buffers.points.len();
        if input.pixels.len() != limit || shifted.sites() > limit {
            let (pixels, sites) = (input.pixels.len(), shifted.sites());
            let why = format!("{pixels} pixels of points, room for {sites} sites; buffers for {limit}");
            return Err(Error::Recording { command: "points_to_insert", why });
        }
        let arguments = PointsToInsertArgs {
            taken: shifted.taken(),
            taken_count: shifted.taken_count()?,
            heirs: shifted.heirs(),
            sites: input.sites,
            pixels: input.pixels.cast(),
            colors: input.colors,
            points: buffers.points.view(),
            starts: buffers.starts.view(),
            count: buffers.count()?,
            width: input.width,
            limit: limit as u32,
        };
        recording.dispatch(&self.kernel, groups_for(limit, WORKGROUP), &arguments);
        Ok(())
    }
}
