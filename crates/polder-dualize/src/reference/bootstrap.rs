//! Where insertion starts when there is no finite triangle.
//!
//! A grid one pixel high has all its sites on one line, although the points are not; and of a thin arc the shift may take
//! out all sites but two, or all. So the mesh that insertion is given may be a chain, or empty:
//!
//! 1. Empty: the lexicographically first and last of all points become a chain of two. If they are equal, all points are
//!    one, and there is nothing to triangulate.
//! 2. A chain: of the points off its line, the one with the least priority joins it; every edge of the chain makes a
//!    triangle with it. It sees them all, since they lie on one line.
//! 3. If no point is off the line, all are on it: their chain, in lexicographic order, is the result.
//!
//! Each step is a minimum over all points, step 3 a sort.

use super::certify::before;
use glam::DVec2;
use polder_flip::priority;
use polder_flip::reference::chain;
use polder_mesh::{DELETED, GHOST, GhostMesh};
use polder_predicates::{Sign, orient2d};

/// What there is to start from.
pub(super) enum Start {
    /// A mesh with a finite triangle, and the points that became vertices of it here.
    Mesh(GhostMesh),
    /// All points lie on one line, or are equal: the finished mesh, and the vertex of each point.
    Line(GhostMesh, Vec<u32>),
}

/// Turns a chain or the empty mesh into a start; `positions` must not be empty.
pub(super) fn bootstrap(mesh: GhostMesh, positions: &[DVec2]) -> Start {
    let at = |v: u32| positions[v as usize];
    let mut vertices: Vec<u32> = mesh.triangles.iter().flatten().copied().filter(|&v| v < DELETED).collect();
    sort(&mut vertices, positions);
    vertices.dedup();
    let all = || 0..positions.len() as u32;
    if vertices.len() < 2 {
        let least = |u: u32, v: u32| if before(at(v), at(u)) { v } else { u };
        let most = |u: u32, v: u32| if before(at(u), at(v)) { v } else { u };
        vertices = vec![all().fold(0, least), all().fold(0, most)];
    }
    let [a, b] = [vertices[0], vertices[vertices.len() - 1]];
    if at(a) == at(b) {
        return Start::Line(GhostMesh::default(), vec![a; positions.len()]);
    }
    let side = |v: u32| orient2d(at(a), at(b), at(v));
    match all().filter(|&v| side(v) != Sign::Zero).min_by_key(|&v| priority(v)) {
        Some(apex) => {
            if side(apex) == Sign::Negative {
                vertices.reverse();
            }
            Start::Mesh(fan(&vertices, apex))
        }
        None => line(positions),
    }
}

/// Step 2: the triangulation of a chain and a vertex to the left of it.
fn fan(chain: &[u32], apex: u32) -> GhostMesh {
    let edges = chain.len() as u32 - 1;
    let mut mesh = GhostMesh::with_slots(2 * edges as usize + 2);
    // Finite triangles first, then the ghost triangles of the chain's edges, then those of the two edges to the apex.
    let (left, right) = (2 * edges, 2 * edges + 1);
    for i in 0..edges {
        let (u, w) = (chain[i as usize], chain[i as usize + 1]);
        mesh.triangles[i as usize] = [u, w, apex];
        mesh.triangles[(edges + i) as usize] = [w, u, GHOST];
        mesh.link(3 * i + 2, 3 * (edges + i) + 2);
        if i > 0 {
            mesh.link(3 * i + 1, 3 * (i - 1));
            mesh.link(3 * (edges + i), 3 * (edges + i - 1) + 1);
        }
    }
    let (first, last) = (chain[0], chain[edges as usize]);
    mesh.triangles[left as usize] = [first, apex, GHOST];
    mesh.triangles[right as usize] = [apex, last, GHOST];
    mesh.link(3 * left + 2, 1);
    mesh.link(3 * right + 2, 3 * (edges - 1));
    mesh.link(3 * left, 3 * right + 1);
    mesh.link(3 * left + 1, 3 * edges);
    mesh.link(3 * right, 3 * (2 * edges - 1) + 1);
    mesh
}

/// Step 3.
fn line(positions: &[DVec2]) -> Start {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    sort(&mut order, positions);
    let mut vertex_of = vec![0; positions.len()];
    let mut vertices: Vec<u32> = Vec::new();
    for &v in &order {
        match vertices.last() {
            Some(&u) if positions[u as usize] == positions[v as usize] => vertex_of[v as usize] = u,
            _ => {
                vertex_of[v as usize] = v;
                vertices.push(v);
            }
        }
    }
    Start::Line(chain(&vertices), vertex_of)
}

/// Sorts points lexicographically, equal ones by number.
fn sort(points: &mut [u32], positions: &[DVec2]) {
    points.sort_unstable_by(|&u, &v| {
        let (p, q) = (positions[u as usize], positions[v as usize]);
        before(q, p).cmp(&before(p, q)).then(u.cmp(&v))
    });
}
