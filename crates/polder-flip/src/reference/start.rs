//! Triangulations to start from, out of nothing but flips.

use super::close_hull;
use crate::{FlipError, FlipReport};
use glam::DVec2;
use polder_mesh::GhostMesh;
use polder_predicates::lexicographic;

/// The mesh of a chain of distinct vertices: no finite triangle, and two ghost triangles to each edge of the chain.
///
/// It is what a triangulation of vertices on one line is, and the smallest start for ghost flips. Fewer than two
/// vertices give the empty mesh.
pub fn chain(vertices: &[u32]) -> GhostMesh {
    let edges = vertices.len().saturating_sub(1);
    let count = 2 * edges;
    let mut mesh = GhostMesh::with_slots(count);
    // The hull runs along the chain and back: its edge j leads from vertex j (or count - j) to the next.
    let vertex = |j: usize| vertices[if j <= edges { j } else { count - j }];
    for j in 0..count {
        mesh.triangles[j] = [vertex(j + 1), vertex(j), polder_mesh::GHOST];
        let (t, following, opposite) = (j as u32, ((j + 1) % count) as u32, (count - 1 - j) as u32);
        mesh.link(3 * t + 1, 3 * following);
        mesh.link(3 * t + 2, 3 * opposite + 2);
    }
    mesh
}

/// Some triangulation of a set of points: their chain in lexicographic order, with its hull closed.
///
/// Vertices are indices into `positions`; of equal points only the lowest index becomes one. The triangles are long
/// and thin: this is the start for examples and tests, not for large sets.
///
/// # Errors
///
/// As [`close_hull`].
pub fn sweep(positions: &[DVec2]) -> Result<(GhostMesh, FlipReport), FlipError> {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    let at = |v: u32| positions[v as usize] + 0.0; // turns -0.0 into 0.0
    order.sort_by(|&a, &b| lexicographic(at(a), at(b)).then(a.cmp(&b)));
    order.dedup_by(|b, a| at(*a) == at(*b));
    let mut mesh = chain(&order);
    let report = close_hull(&mut mesh, positions)?;
    Ok((mesh, report))
}
