//! The counts behind the figures: how many triangles constraints run through, and how many flips it takes to have them in.
//!
//! As in \[QCT\] 5.1 constraints go into the Delaunay triangulation of the points, and flips are those that make them edges
//! and those that make the result constrained Delaunay. The triangulation is that of the CPU backend, the rest is that of the
//! references: of chains that are short enough to be rebuilt as well.

use glam::DVec2;
use polder_constrain::{ConstrainError, InsertReport, reference};
use polder_cpu::Delaunay;
use polder_mesh::{GhostMesh, Monitor, Pslg};
use serde::Serialize;
use std::collections::BTreeMap;

/// What constraints cost on one input.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Sample {
    pub(crate) set: String,
    pub(crate) points: usize,
    pub(crate) constraints: usize,
    /// Pairs of a constraint and a triangle of the Delaunay triangulation that it runs through.
    pub(crate) intersections: u64,
    /// Flips that made edges of the constraints.
    pub(crate) inserting: u64,
    /// Flips from there to the constrained Delaunay triangulation.
    pub(crate) restoring: u64,
    pub(crate) outer_rounds: u64,
    pub(crate) inner_rounds: u64,
    /// How many constraints run through so many triangles.
    #[serde(skip)]
    pub(crate) distribution: BTreeMap<u64, u64>,
}

impl Sample {
    pub(crate) fn flips(&self) -> u64 {
        self.inserting + self.restoring
    }

    pub(crate) fn most(&self) -> u64 {
        self.distribution.last_key_value().map_or(0, |(&most, _)| most)
    }

    pub(crate) fn of(set: &str, pslg: &Pslg) -> Result<Self, String> {
        let delaunay = Delaunay::new(pslg.points(), Monitor::default()).map_err(|error| error.to_string())?;
        let (mut mesh, positions, names) = delaunay.to_ghost_mesh();
        let ends = ends(pslg, delaunay.representatives(), &names);
        drop(delaunay);
        let walk = reference::walk(&mesh, &positions, &ends).map_err(|error| error.to_string())?;
        // A triangle counts once for each piece between two vertices that runs through it.
        let of_piece = |&s: &u32| match u64::from(walk.crossed_edges[s as usize]) {
            0 => 0,
            edges => edges + 1,
        };
        let mut distribution = BTreeMap::new();
        for i in 0..ends.len() {
            *distribution.entry(walk.pieces(i).iter().map(of_piece).sum()).or_default() += 1;
        }
        let inserted = by_flips(&mut mesh, &positions, &walk.sub_constraints).map_err(|error| error.to_string())?;
        let restored = polder_flip::reference::flip(&mut mesh, &positions).map_err(|error| error.to_string())?;
        Ok(Self {
            set: set.to_owned(),
            points: pslg.points().len(),
            constraints: ends.len(),
            intersections: walk.intersections(),
            inserting: inserted.all_flips(),
            restoring: restored.flips,
            outer_rounds: inserted.outer_rounds,
            inner_rounds: inserted.inner_rounds,
            distribution,
        })
    }
}

/// Insertion by flips alone, short chains as well.
fn by_flips(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    sub_constraints: &[[u32; 2]],
) -> Result<InsertReport, ConstrainError> {
    let mut insertion = reference::Insertion::new(mesh, positions, sub_constraints)?;
    insertion.set_longest_rebuilt(0);
    while !insertion.is_done() {
        insertion.outer_round()?;
    }
    Ok(insertion.report())
}

/// The constraints as pairs of vertices; `of` says which point stands for each, and `names` which point each vertex is.
fn ends(pslg: &Pslg, of: &[u32], names: &[u32]) -> Vec<[u32; 2]> {
    let mut vertex_of = vec![0; of.len()];
    for (vertex, &name) in names.iter().enumerate() {
        vertex_of[name as usize] = vertex as u32;
    }
    let vertex = |point: u32| vertex_of[of[point as usize] as usize];
    pslg.constraints().iter().map(|ends| ends.map(vertex)).collect()
}
