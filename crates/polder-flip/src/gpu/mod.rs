//! The stage on the device, bit for bit what [`reference`](mod@crate::reference) gives, and the working mesh that stages
//! share there.

mod buffers;
mod mesh;
mod predicates;
mod record;

pub use buffers::{Buffers, EdgeList, Tally, TallyRead};
pub use mesh::{CONSTRAINED, HALF_EDGE, MOST_SLOTS, Mesh};
pub use predicates::{Arithmetic, Kernels, Signs};
pub use record::TAIL_ROUNDS;

use crate::kernels::*;
use polder_vulkan::{Device, DeviceKind, Error, Estimate, Kernel};

/// Workgroups of a wide kernel on a GPU, and on a CPU that plays one.
const GROUPS: u32 = 1056;
const FEW_GROUPS: u32 = 16;

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    /// Workgroups of wide kernels, which stride over their items.
    groups: [u32; 3],
    test_mesh: Kernel<TestMesh>,
    test_edges: Kernel<TestEdges>,
    flip_edges: Kernel<FlipEdges>,
    relink_edges: Kernel<RelinkEdges>,
    advance_edges: Kernel<AdvanceEdges>,
    flip_tail: Kernel<FlipTail>,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_arithmetic(device, Arithmetic::of(device)?)
    }

    /// With a given arithmetic: for tests, and where the device was asked before.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn with_arithmetic(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let groups = if device.info().kind == DeviceKind::Cpu { FEW_GROUPS } else { GROUPS };
        Ok(Self {
            device: device.clone(),
            groups: [groups, 1, 1],
            test_mesh: arithmetic.kernel(device, &[])?,
            test_edges: arithmetic.kernel(device, &[])?,
            flip_edges: Kernel::new(device, &[])?,
            relink_edges: Kernel::new(device, &[])?,
            advance_edges: arithmetic.kernel(device, &[])?,
            flip_tail: arithmetic.kernel(device, &[])?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(&self, slots: usize) -> Estimate {
        buffers::estimate(slots)
    }

    /// Scratch memory for meshes of up to so many slots.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, slots: usize) -> Result<Buffers, Error> {
        Buffers::new(&self.device, slots)
    }
}
