//! The stage on the device, bit for bit what [`reference`](mod@crate::reference) gives, and the working mesh that stages
//! share there. \[QCT\] section 3.5.
//!
//! [`Stage`] holds the kernels, [`Buffers`] the memory for one number of slots, [`Mesh`] what is flipped. A round:
//!
//! 1. *Test and claim.* Illegal edges are listed, and claim their two triangles by an atomic minimum of the priority. The
//!    first round reads the whole mesh, a triangle an invocation, which tests the edges of which that is the lower side.
//! 2. *Flip.* An edge that has both its triangles is flipped: their corners and links are nobody else's to write. Links
//!    outward keep the names that the neighbors had before the round; a stamp on each triangle says that it was flipped in
//!    this round, and along which edge. Who got a triangle gives it back.
//! 3. *Renew and test again.* From a neighbor's stamp follows where the edge between is now: a flip moves two of its four
//!    outer edges to the other triangle. Each side writes its own link, and that of a neighbor that was not flipped. The
//!    edge so renewed is tested at once, which is step 1 of the next round: its corners, final since step 2, are at hand. An
//!    edge between two flips is renewed by both and tested by one, so no list ever holds an edge twice.
//!
//! A round is therefore two dispatches. [`Stage::record_flip`] repeats some of them and a *tail*: once few edges are
//! illegal, whole rounds run inside one workgroup, with their list in shared memory. Which kernel makes a round cannot be
//! told from the result.
//!
//! [`Stage::record_round`] makes a single round over a list to which other kernels append in any order (`edge_list.glsl`),
//! each edge once. [`Stage::record_close_hull`] makes ghost flips alone; in its list edges may repeat, and a bit for each
//! half-edge sorts that out.
//!
//! Departures from the paper, beside those of the reference: rounds are not separated by the host; a claim is the minimum
//! of a hash; links are renewed from stamps, not through an array of messages; what is listed is edges.
//!
//! # Cost
//!
//! Memory: 28.4 bytes a slot beside the mesh, which is 57 a point. A flip reads and writes, in two dispatches, its two
//! triangles and up to four neighbors, a sector of 32 bytes each with corners, links and stamp; and claims and positions.
//!
//! Kernels read all they need of a triangle before they write any of it: what has been written is no longer at hand in the
//! cache of a multiprocessor, and neither is what lies beside it. Claims are an array of their own, since atomics in the
//! sectors of triangles hold up those who read there.

mod buffers;
mod mesh;
mod predicates;
mod record;

pub use buffers::{Buffers, EdgeList, Tally, TallyRead};
pub use mesh::{CONSTRAINED, HALF_EDGE, MOST_SLOTS, Mesh};
pub use predicates::{Arithmetic, Signs};

use crate::kernels::*;
use polder_vulkan::{Device, DeviceKind, Error, Estimate, Kernel};

/// Rounds that [`Stage::record_close_hull`] takes at least before it leaves a hull that is not closed.
pub const TAIL_ROUNDS: u32 = 8192;

/// How much is done in one dispatch.
#[derive(Debug)]
struct Pace {
    /// Workgroups of wide kernels, which stride over their items.
    groups: u32,
    /// Rounds of a tail, and illegal edges taken in all of them, but for those of the last.
    rounds: u32,
    flips: u32,
    /// Rounds of a tail that closes a hull, and tails.
    hull_rounds: u32,
    hull_tails: u32,
}

impl Pace {
    /// No dispatch takes long.
    const GPU: Self = Self { groups: 1056, rounds: 8192, flips: 1 << 20, hull_rounds: TAIL_ROUNDS, hull_tails: 2 };
    /// lavapipe leaves a shader, without a word, once its loops have made 65535 turns, those of the predicates included.
    const CPU: Self = Self { groups: 64, rounds: 16, flips: 512, hull_rounds: TAIL_ROUNDS / 8, hull_tails: 8 };
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    pace: Pace,
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
        Ok(Self {
            device: device.clone(),
            pace: if device.info().kind == DeviceKind::Cpu { Pace::CPU } else { Pace::GPU },
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
