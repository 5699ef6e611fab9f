//! Inputs, and checks by definition.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests; each file uses a part")]

use glam::DVec2;
use polder_constrain::reference;
use polder_flip::reference::{flip, sweep};
use polder_mesh::{Chains, GHOST, GhostMesh, Parts, Triangulation};
use polder_predicates::{Sign, lexicographic, must_flip, orient2d};
use proptest::prelude::*;

pub type Input = (Vec<DVec2>, Vec<[u32; 2]>);

pub fn points(list: &[(i32, i32)]) -> Vec<DVec2> {
    list.iter().map(|&(x, y)| DVec2::new(x.into(), y.into())).collect()
}

pub fn distinct(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| lexicographic(*a, *b));
    points.dedup();
    points
}

/// Numbers that look random between 0 and 1: the same on every run.
pub fn unit(seed: u32, i: usize) -> f64 {
    f64::from(polder_flip::priority(seed.wrapping_mul(0x9e37_79b9).wrapping_add(i as u32))) / f64::from(u32::MAX)
}

pub fn uniform(n: usize, seed: u32) -> Vec<DVec2> {
    (0..n).map(|i| DVec2::new(unit(seed, 2 * i), unit(seed, 2 * i + 1))).collect()
}

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

pub fn canonical(mesh: &GhostMesh, positions: &[DVec2]) -> Triangulation {
    let names: Vec<u32> = (0..positions.len() as u32).collect();
    Triangulation::from_mesh(mesh, &names, Parts { representatives: names.clone(), chains: Chains::default() })
}

pub fn constrained_edges(mesh: &GhostMesh) -> Vec<[u32; 2]> {
    let all = (0..3 * mesh.slots() as u32).filter(|&h| h < mesh.twin(h) && mesh.is_constrained(h));
    let mut edges: Vec<[u32; 2]> = all.map(|h| [mesh.origin(h), mesh.destination(h)]).collect();
    edges.iter_mut().for_each(|e| e.sort_unstable());
    edges.sort_unstable();
    edges
}

/// A triangulation of the hull by definition: topology, orientation, every vertex used, a hull with nothing outside, and
/// Euler's count, which with these leaves no room for overlaps of a hull that winds once.
pub fn check_triangulation(mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), String> {
    mesh.check().map_err(|e| e.to_string())?;
    let at = |v: u32| positions[v as usize];
    for t in mesh.finite() {
        let [a, b, c] = mesh.triangles[t].map(at);
        if orient2d(a, b, c) != Sign::Positive {
            return Err(format!("triangle {t} is not counterclockwise"));
        }
    }
    for h in (0..3 * mesh.slots() as u32).filter(|&h| mesh.apex(h) == GHOST) {
        let (a, b) = (at(mesh.destination(h)), at(mesh.origin(h)));
        if positions.iter().any(|&p| orient2d(a, b, p) == Sign::Negative) {
            return Err(format!("a point lies outside the hull edge of half-edge {h}"));
        }
    }
    let mut used = vec![false; positions.len()];
    mesh.triangles.iter().flatten().filter(|&&v| v != GHOST).for_each(|&v| used[v as usize] = true);
    if used.contains(&false) {
        return Err("a vertex is not used".into());
    }
    if mesh.slots() != 2 * (positions.len() - 1) {
        return Err(format!("{} triangles", mesh.slots()));
    }
    Ok(())
}

/// [`check_triangulation`], and no unconstrained edge is illegal, by definition.
pub fn check_delaunay(mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), String> {
    check_triangulation(mesh, positions)?;
    let at = |v: u32| positions[v as usize];
    for h in 0..3 * mesh.slots() as u32 {
        let g = mesh.twin(h);
        let finite = mesh.is_finite((h / 3) as usize) && mesh.is_finite((g / 3) as usize);
        if finite
            && !mesh.is_constrained(h)
            && must_flip(at(mesh.apex(h)), at(mesh.origin(h)), at(mesh.destination(h)), at(mesh.apex(g)))
        {
            return Err(format!("half-edge {h} is illegal"));
        }
    }
    Ok(())
}
