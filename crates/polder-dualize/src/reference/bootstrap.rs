//! Where insertion starts when there is no finite triangle.
//!
//! A grid one pixel high has all its sites on one line, although the points are not; and of a thin arc the shift may take
//! out all sites but two, or all. So the mesh that insertion is given may be a chain, or empty:
//!
//! 1. Empty: the lexicographically first and last of all points become a chain of two. If they are equal, all points are
//!    one, and there is nothing to triangulate. Of `n` points all but one have slots of their own. The chain takes those
//!    of one of its two points; the other's go to the point without.
//! 2. A chain: of the points off its line, the one with the least priority joins it. It sees every edge of the chain from
//!    the same side: the ghost triangles on that side get it as their corner in place of the ghost vertex, and at both
//!    ends of the chain a new ghost triangle goes in between.
//! 3. If no point is off the line, all are on it: their chain, in lexicographic order, is the result.
//!
//! Each step is a minimum over all points, step 3 a sort.

use super::certify::before;
use super::kernels::insert::{insert_apex, insert_ends, insert_join};
use glam::DVec2;
use polder_flip::priority;
use polder_flip::reference::chain;
use polder_mesh::{DELETED, GHOST, GhostMesh, NONE};

/// What there is to start from.
pub(super) enum Start {
    /// A mesh with a finite triangle.
    Mesh(GhostMesh),
    /// All points lie on one line, or are equal: the finished mesh, and the vertex of each point.
    Line(GhostMesh, Vec<u32>),
}

/// Turns a chain or the empty mesh into a start; `positions` must not be empty. `slots` are those of each point, free.
pub(super) fn bootstrap(mut mesh: GhostMesh, positions: &[DVec2], slots: &mut [[u32; 2]]) -> Start {
    let vertices: Vec<u32> = mesh.triangles.iter().flatten().copied().filter(|&v| v < DELETED).collect();
    let empty = vertices.is_empty();
    let [a, b] = if empty {
        insert_ends(positions, 0..positions.len() as u32)
    } else {
        insert_ends(positions, vertices.into_iter())
    };
    if positions[a as usize] == positions[b as usize] {
        return Start::Line(GhostMesh::default(), vec![a; positions.len()]);
    }
    let least = insert_apex(positions, [a, b]);
    let Some(apex) = (0..positions.len() as u32).find(|&v| priority(v) == least && least != NONE) else {
        return line(positions);
    };
    if empty {
        let keeps = if slots[a as usize][0] == NONE { b } else { a };
        let gives = a + b - keeps;
        lay(&mut mesh, [a, b], slots[keeps as usize]);
        if let Some(without) = slots.iter().position(|pair| pair[0] == NONE) {
            slots[without] = slots[gives as usize];
        }
    }
    insert_join(&mut mesh, positions, apex, slots[apex as usize]);
    Start::Mesh(mesh)
}

/// Step 1: the chain of two vertices, in two free slots.
fn lay(mesh: &mut GhostMesh, [a, b]: [u32; 2], [s, t]: [u32; 2]) {
    mesh.triangles[s as usize] = [b, a, GHOST];
    mesh.triangles[t as usize] = [a, b, GHOST];
    mesh.link(3 * s + 2, 3 * t + 2);
    mesh.link(3 * s, 3 * t + 1);
    mesh.link(3 * s + 1, 3 * t);
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
