//! A constraint, and others that its own flips make edges although they cross it.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "tests")]

use glam::DVec2;
use polder_constrain::reference::triangle_chain;
use polder_mesh::GhostMesh;

/// The constraint first, then the other diagonals of some edges that it crosses: of some the ends lie on either side of it too.
pub fn with_diagonals(mesh: &GhostMesh, positions: &[DVec2], constraint: [u32; 2]) -> Vec<[u32; 2]> {
    let chain = triangle_chain(mesh, positions, constraint).unwrap().triangles;
    let edges = chain.iter().flat_map(|&t| (0..3).map(move |k| 3 * t + k));
    let crossed = edges.filter(|&h| chain.contains(&(mesh.twin(h) / 3))).step_by(5);
    let diagonals = crossed.map(|h| [mesh.apex(h), mesh.apex(mesh.twin(h))]);
    std::iter::once(constraint).chain(diagonals).collect()
}
