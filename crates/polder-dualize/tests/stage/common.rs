//! Helpers of this crate's tests.

use polder_dualize::reference::Phases;
use polder_dualize::{DVec2, reference};
use polder_mesh::{Chains, GhostMesh, Parts, Triangulation};
use polder_voronoi::Options;

/// A small generator of numbers that needs no package (xorshift64*).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub(crate) fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.next()) * u128::from(n)) >> 64) as u64
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn point(&mut self) -> DVec2 {
        DVec2::new(self.unit(), self.unit())
    }
}

/// Points with integer coordinates below `side`.
pub(crate) fn lattice_points(random: &mut Random, n: usize, width: u64, height: u64) -> Vec<DVec2> {
    (0..n).map(|_| DVec2::new(random.below(width) as f64, random.below(height) as f64)).collect()
}

/// The canonical Delaunay triangulation by flips from the chain of sorted points: another way than through the grid.
pub(crate) fn by_sweep(points: &[DVec2]) -> Triangulation {
    let (mut mesh, _) = polder_flip::reference::sweep(points).unwrap();
    polder_flip::reference::flip(&mut mesh, points).unwrap();
    let names: Vec<u32> = (0..points.len() as u32).collect();
    let mut representatives = names.clone();
    for i in 0..points.len() {
        representatives[i] = (0..=i).find(|&j| points[j] == points[i]).unwrap() as u32;
    }
    Triangulation::from_mesh(&mesh, &names, Parts { representatives, chains: Chains::default() })
}

/// The canonical Delaunay triangulation through all stages.
pub(crate) fn finish(points: &[DVec2], phases: &Phases) -> Triangulation {
    let positions = phases.positions(points);
    let mut mesh = phases.inserted.mesh.clone();
    polder_flip::reference::flip(&mut mesh, &positions).unwrap();
    let order = &phases.voronoi.sites.order;
    let names = phases.inserted.names(order);
    let representatives = phases.inserted.representatives(order, &names);
    Triangulation::from_mesh(&mesh, &names, Parts { representatives, chains: Chains::default() })
}

/// Runs all stages, checks what holds for every input, and returns them.
pub(crate) fn phases(points: &[DVec2]) -> Phases {
    phases_with(points, &Options::default())
}

pub(crate) fn phases_with(points: &[DVec2], options: &Options) -> Phases {
    let phases = reference::triangulate(points, options).unwrap_or_else(|e| panic!("{e}: {points:?}"));
    let distinct = |mut of: Vec<u32>| {
        of.sort_unstable();
        of.dedup();
        of.len()
    };
    let sites = phases.voronoi.sites.count;
    check_sphere(&phases.dualized.mesh, sites);
    let mut shifted = phases.shifted.mesh.clone();
    shifted.check().unwrap();
    shifted.compact();
    check_sphere(&shifted, sites - phases.shifted.taken_out().count());
    let mut inserted = phases.inserted.mesh.clone();
    inserted.check().unwrap();
    inserted.compact();
    check_sphere(&inserted, distinct(phases.inserted.vertex_of.clone()));
    phases
}

/// Links, the number of triangles of a sphere, and no free slot.
pub(crate) fn check_sphere(mesh: &GhostMesh, vertices: usize) {
    mesh.check().unwrap();
    let expected = if vertices < 2 { 0 } else { 2 * vertices - 2 };
    assert_eq!(mesh.slots(), expected, "{vertices} vertices\n{mesh}");
    assert!((0..mesh.slots()).all(|t| !mesh.is_deleted(t)));
}
