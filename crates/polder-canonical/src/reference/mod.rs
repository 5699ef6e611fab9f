//! The step in plain Rust: what the kernels reproduce, bit for bit.

mod check;
pub mod kernels;
mod line;

pub use check::{Check, certify, check_triangles};
pub use line::{Axis, line, line_chains, line_heads, line_keys, line_lengths, line_names, line_places};

use polder_mesh::{GhostMesh, NONE};

/// A triangulation in canonical order, as arrays: what [`polder_mesh::Triangulation`] holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Canonical {
    /// Corners by input index, the smallest first, counterclockwise; sorted.
    pub triangles: Vec<[u32; 3]>,
    /// The triangle across the edge opposite each corner, [`NONE`] at the hull.
    pub neighbors: Vec<[u32; 3]>,
    /// For each triangle, bit `k` says that edge `k` is constrained.
    pub constrained: Vec<u8>,
    /// For each input point the input index of its vertex: the lowest of the points equal to it.
    pub representatives: Vec<u32>,
}

/// Puts the finite triangles of a mesh into canonical order. `vertex_of` gives for each point the vertex that it is or
/// equals, `order` its input index.
pub fn canonical(mesh: &GhostMesh, vertex_of: &[u32], order: &[u32]) -> Canonical {
    let (mut names, mut representatives) = kernels::start_names(order);
    kernels::elect_names(vertex_of, order, &mut names);
    kernels::name_points(vertex_of, order, &names, &mut representatives);

    let mut finite: Vec<([u32; 3], usize, usize)> = mesh.finite().map(|t| rotated(mesh, t, &names)).collect();
    finite.sort_unstable();
    let mut places = vec![NONE; mesh.slots()];
    for (place, &(_, t, _)) in finite.iter().enumerate() {
        places[t] = place as u32;
    }
    let mut out = Canonical { representatives, ..Canonical::default() };
    for (corners, t, by) in finite {
        let edges = [0, 1, 2].map(|j| (3 * t + (by + j) % 3) as u32);
        out.triangles.push(corners);
        out.neighbors.push(edges.map(|h| places[mesh.twin(h) as usize / 3]));
        out.constrained.push((0..3).map(|j| u8::from(mesh.is_constrained(edges[j])) << j).sum());
    }
    out
}

/// The names of a triangle's corners from the smallest on, its slot, and which corner that is.
fn rotated(mesh: &GhostMesh, t: usize, names: &[u32]) -> ([u32; 3], usize, usize) {
    let named = mesh.triangles[t].map(|v| names[v as usize]);
    let turned = |by: usize| [named[by], named[(by + 1) % 3], named[(by + 2) % 3]];
    let by = (0..3).min_by_key(|&by| named[by]).unwrap_or(0);
    (turned(by), t, by)
}
