//! Meshes for constraints to be put into.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests; each file uses a part")]

use glam::DVec2;
use polder_constrain::gpu::pieces::Grid;
use polder_constrain::reference;
use polder_mesh::{GhostMesh, NONE, Parts, Pslg, Triangulation};

/// A mesh over vertices, and a PSLG's constraints as pairs of them.
#[derive(Clone)]
pub struct Start {
    pub mesh: GhostMesh,
    pub positions: Vec<DVec2>,
    /// The input point of each vertex.
    pub names: Vec<u32>,
    pub representatives: Vec<u32>,
    pub constraints: Vec<[u32; 2]>,
}

impl Start {
    /// The triangulation of stages 1 to 4, which is close to Delaunay but not there.
    pub fn stage_4(pslg: &Pslg) -> Self {
        let phases = polder_dualize::reference::triangulate(pslg.points(), &Default::default()).unwrap();
        let order = &phases.voronoi.sites.order;
        let names = phases.inserted.names(order);
        let representatives = phases.inserted.representatives(order, &names);
        let mut vertex_of_name = vec![NONE; pslg.points().len()];
        for (v, &name) in names.iter().enumerate() {
            if phases.inserted.vertex_of[v] == v as u32 {
                vertex_of_name[name as usize] = v as u32;
            }
        }
        let vertex = |i: u32| vertex_of_name[representatives[i as usize] as usize];
        let constraints = pslg.constraints().iter().map(|c| c.map(vertex)).collect();
        let positions = phases.positions(pslg.points());
        Self { mesh: phases.inserted.mesh, positions, names, representatives, constraints }
    }

    /// The Delaunay triangulation by the CPU's own way, over vertices in another order.
    pub fn delaunay(pslg: &Pslg) -> Self {
        let delaunay = polder_cpu::Delaunay::new(pslg.points(), Default::default()).unwrap();
        let (mesh, positions, names) = delaunay.to_ghost_mesh();
        let constraints = delaunay.vertices_of(pslg.constraints()).unwrap();
        Self { mesh, positions, names, representatives: delaunay.representatives().to_vec(), constraints }
    }

    /// Puts the constraints in and flips; the result in the input's numbering.
    pub fn constrained(mut self) -> Triangulation {
        let done = reference::constrain(&mut self.mesh, &self.positions, &self.constraints, 100);
        let mut chains = done.unwrap().0.chains;
        chains.rename(&self.names);
        Triangulation::from_mesh(&self.mesh, &self.names, Parts { representatives: self.representatives, chains })
    }
}

/// A grid over all points, of which there is one at least.
pub fn grid(positions: &[DVec2]) -> Grid {
    let [low, high] = [DVec2::min, DVec2::max].map(|f| positions.iter().copied().reduce(f).unwrap());
    Grid::over(low, high, positions.len())
}
