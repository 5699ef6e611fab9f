//! Inputs; points and checks by definition are those of polder-flip's tests.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests; each file uses a part")]

use glam::DVec2;
use polder_constrain::reference;
use polder_flip::reference::{flip, sweep};
use polder_mesh::GhostMesh;
use proptest::prelude::*;

#[path = "../../../polder-flip/tests/common/mod.rs"]
mod meshes;
pub use meshes::*;

pub type Input = (Vec<DVec2>, Vec<[u32; 2]>);

pub fn delaunay(positions: &[DVec2]) -> GhostMesh {
    let (mut mesh, _) = sweep(positions).unwrap();
    flip(&mut mesh, positions).unwrap();
    mesh
}

/// The constraints that cross none before them.
pub fn without_crossings(positions: &[DVec2], constraints: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mesh = delaunay(positions);
    let walk = reference::walk(&mesh, positions, constraints).unwrap();
    let crossings = reference::crossings(&mesh, positions, &walk, usize::MAX).unwrap();
    let mut by_higher = crossings.pairs;
    by_higher.sort_unstable_by_key(|&[i, j]| (j, i));
    let mut out = vec![false; constraints.len()];
    for [i, j] in by_higher {
        if !out[i as usize] {
            out[j as usize] = true;
        }
    }
    (0..constraints.len()).filter(|&i| !out[i]).map(|i| constraints[i]).collect()
}

/// Points on a small grid and constraints between them that do not cross; many meet, overlap and repeat.
pub fn grid(side: i32, count: usize, segments: usize) -> impl Strategy<Value = Input> {
    let positions = prop::collection::vec((0..side, 0..side), 3..count).prop_map(|list| distinct(points(&list)));
    positions
        .prop_flat_map(move |positions| {
            let n = positions.len() as u32;
            (Just(positions), prop::collection::vec([0..n, 0..n], 0..segments))
        })
        .prop_map(|(positions, constraints)| {
            let constraints = without_crossings(&positions, &constraints);
            (positions, constraints)
        })
}

pub fn constrained_edges(mesh: &GhostMesh) -> Vec<[u32; 2]> {
    let all = (0..3 * mesh.slots() as u32).filter(|&h| h < mesh.twin(h) && mesh.is_constrained(h));
    let mut edges: Vec<[u32; 2]> = all.map(|h| [mesh.origin(h), mesh.destination(h)]).collect();
    edges.iter_mut().for_each(|e| e.sort_unstable());
    edges.sort_unstable();
    edges
}
