//! The CPU backend: the fastest way to the canonical triangulation on a CPU that needs nothing installed.
//!
//! The stages of the GPU pipeline are rounds of small equal pieces of work; a CPU core prefers one long thread of
//! work on nearby memory. So this crate goes its own way to the same triangles:
//!
//! 1. [`Delaunay::new`]: points in Morton order, duplicates found; divide and conquer, halves in threads.
//! 2. [`Delaunay::constrain`]: constraints one by one: the triangles that each one crosses are taken out, both sides are
//!    triangulated again, and flips restore the constrained Delaunay property.
//! 3. [`Delaunay::finish`]: the canonical order.
//!
//! All ties are broken canonically on the way, so that the result is the one that every backend gives.
//!
//! ```
//! use polder_cpu::Delaunay;
//! use polder_mesh::{DVec2, Monitor};
//!
//! let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
//! let mut delaunay = Delaunay::new(&points, Monitor::default())?;
//! let (chains, _) = delaunay.constrain(&[[1, 3]], Monitor::default())?;
//! let triangulation = delaunay.finish(chains);
//! assert_eq!(triangulation.triangles(), [[0, 1, 3], [1, 2, 3]]);
//! # Ok::<(), polder_cpu::CpuError>(())
//! ```
#![forbid(unsafe_code)]

mod cavity;
mod constrain;
mod divide;
mod error;
mod mesh;
mod order;
mod walk;

pub use constrain::ConstrainCounts;
pub use error::CpuError;

use mesh::Tri;
use order::Order;
use polder_mesh::{Chains, DELETED, DVec2, GhostMesh, Monitor, Parts, Slot, Triangulation};

/// The canonical Delaunay triangulation of a point set, and the constraints put into it so far.
#[derive(Clone, Debug)]
pub struct Delaunay {
    order: Order,
    tris: Vec<Tri>,
}

impl Delaunay {
    /// Triangulates points, which must be finite. Threads are those of the current rayon pool.
    ///
    /// # Errors
    ///
    /// [`CpuError::Cancelled`] if the monitor says so.
    pub fn new(points: &[DVec2], monitor: Monitor<'_>) -> Result<Self, CpuError> {
        monitor.step("order", 0, 1)?;
        let order = order::order(points);
        let tris = divide::delaunay(&order, monitor)?;
        Ok(Self { order, tris })
    }

    /// The number of distinct points.
    pub fn vertices(&self) -> usize {
        self.order.points.len()
    }

    /// For each input point the lowest point equal to it.
    pub fn representatives(&self) -> &[u32] {
        &self.order.representatives
    }

    /// The triangulation as a working mesh over vertices in the backend's own order, their positions, and the input
    /// point of each.
    pub fn to_ghost_mesh(&self) -> (GhostMesh, Vec<DVec2>, Vec<u32>) {
        let mesh = GhostMesh {
            triangles: self.tris.iter().map(|t| [t.v[0], t.v[1], t.v[2]]).collect(),
            links: self.tris.iter().map(|t| [t.n[0], t.n[1], t.n[2]].map(|h| 3 * (h >> 2) + (h & 3))).collect(),
            constrained: self.tris.iter().map(|t| t.v[3] as u8).collect(),
        };
        (mesh, self.order.points.clone(), self.order.ids.clone())
    }

    /// The result in canonical order.
    pub fn finish(self, chains: Chains) -> Triangulation {
        let Self { order, tris } = self;
        let Order { ids, representatives, .. } = order;
        // The closure owns the working mesh, so that its memory is free again once the triangles are read.
        let slots = tris.len();
        let get = move |t: usize| {
            let Tri { v: [a, b, c, marks], n: [l, m, n, _] } = tris[t];
            let finite = a < DELETED && b < DELETED && c < DELETED;
            finite.then(|| Slot {
                corners: [ids[a as usize], ids[b as usize], ids[c as usize]],
                neighbors: [l >> 2, m >> 2, n >> 2],
                constrained: marks as u8,
            })
        };
        // Ghosts have no place in the canonical order, so that a neighbor that is one comes out as none.
        Triangulation::from_slots(slots, get, Parts { representatives, chains })
    }
}
