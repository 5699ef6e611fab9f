//! Points, and checks of meshes by definition; polder-constrain's tests use them too.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests; each file uses a part")]

use glam::DVec2;
use polder_mesh::{Chains, GHOST, GhostMesh, Parts, Triangulation};
use polder_predicates::{Sign, lexicographic, must_flip, orient2d};

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

pub fn canonical(mesh: &GhostMesh, positions: &[DVec2]) -> Triangulation {
    let names: Vec<u32> = (0..positions.len() as u32).collect();
    Triangulation::from_mesh(mesh, &names, Parts { representatives: names.clone(), chains: Chains::default() })
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
