//! The step on the device, bit for bit what [`reference`](crate::reference) gives.
//!
//! Triangles are sorted in the numbering of the stages, where all that belongs together lies close together; only results
//! go to distant places, each once.
//!
//! 1. *Names*: each vertex is named by the lowest input index of the points equal to it.
//! 2. *Lists*: each finite triangle goes to the list of its smallest vertex (by name), in the order of arrival, which a
//!    counting pass gave it.
//! 3. *Places*: a scan over the lengths of the lists, in the order of names, says where each list begins in the result; in
//!    a list no two triangles share their second corner, so a triangle's place is the number of lower ones. Long lists
//!    (a hub with its fan) are sorted by a workgroup each.
//! 4. *Output*: each triangle, with its neighbors' places, goes to its own.
//! 5. *Chains*, if there are constraints: the vertices along each get their names.
//! 6. *Certificate* (module [`reference`](crate::reference)): one look at each triangle and the ones next to it.

mod buffers;
mod line;
mod record;

pub use buffers::{Buffers, Counts, CountsRead};
pub use line::{Line, LineChains, LineChainsRead, LineRead};
pub use record::{Chains, Input};

use crate::kernels::*;
use polder_flip::gpu::Arithmetic;
use polder_vulkan::kernels::DispatchSize;
use polder_vulkan::{Device, Error, Estimate, Kernel};

/// Invocations of a workgroup, the same in all kernels but the sort of long lists.
const WORKGROUP: u32 = 256;

/// The kernels of the step on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    longest: u32,
    start_names: Kernel<StartNames>,
    elect_names: Kernel<ElectNames>,
    name_points: Kernel<NamePoints>,
    count_triangles: Kernel<CountTriangles>,
    spread_counts: Kernel<SpreadCounts>,
    list_triangles: Kernel<ListTriangles>,
    place_triangles: Kernel<PlaceTriangles>,
    dispatch_size: Kernel<DispatchSize>,
    sort_long: Kernel<SortLong>,
    write_triangles: Kernel<WriteTriangles>,
    check_triangles: Kernel<CheckTriangles>,
    name_chains: Kernel<NameChains>,
    count_constrained: Kernel<CountConstrained>,
}

/// The longest list that is compared all with all.
const LONGEST: u32 = 32;

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        Self::with_longest(device, arithmetic, LONGEST)
    }

    /// With another length from which lists count as long: for measurements and tests. The result does not depend on it.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn with_longest(device: &Device, arithmetic: Arithmetic, longest: u32) -> Result<Self, Error> {
        let limits = device.info().limits;
        let wide = limits.workgroup_invocations.min(1024) / limits.subgroup * limits.subgroup;
        Ok(Self {
            device: device.clone(),
            longest,
            start_names: Kernel::new(device, &[])?,
            elect_names: Kernel::new(device, &[])?,
            name_points: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            count_triangles: Kernel::new(device, &[("WORKGROUP", WORKGROUP)])?,
            spread_counts: Kernel::new(device, &[])?,
            list_triangles: Kernel::new(device, &[])?,
            place_triangles: Kernel::new(device, &[])?,
            dispatch_size: Kernel::new(device, &[])?,
            sort_long: Kernel::new(device, &[("WORKGROUP", wide)])?,
            write_triangles: Kernel::new(device, &[])?,
            check_triangles: arithmetic.kernel(device, &[])?,
            name_chains: Kernel::new(device, &[])?,
            count_constrained: Kernel::new(device, &[])?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(&self, points: usize, slots: usize) -> Estimate {
        buffers::estimate(points, slots)
    }

    /// Memory for so many points, and meshes of so many slots.
    ///
    /// # Errors
    ///
    /// If the numbers are impossible, or the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, points: usize, slots: usize) -> Result<Buffers, Error> {
        Buffers::new(&self.device, points, slots)
    }
}
