//! Tests of what the stages are made of; the stages as wholes are tested in `tests/stage`.
#![allow(clippy::unwrap_used, reason = "tests")]

mod bootstrap;
mod certify;
mod locate;
mod sector;
mod takeout;

use glam::DVec2;
use polder_flip::reference::{flip, sweep};
use polder_mesh::GhostMesh;

/// A Delaunay triangulation of points.
fn delaunay(points: &[DVec2]) -> GhostMesh {
    let (mut mesh, _) = sweep(points).unwrap();
    flip(&mut mesh, points).unwrap();
    mesh
}

/// Points with integer coordinates, row by row.
fn lattice(width: u32, height: u32) -> Vec<DVec2> {
    (0..width * height).map(|i| DVec2::new(f64::from(i % width), f64::from(i / width))).collect()
}

/// A triangulation that is not Delaunay: long triangles, as the sweep leaves them.
fn slivers(points: &[DVec2]) -> GhostMesh {
    sweep(points).unwrap().0
}

/// Points scattered over the unit square, the same ones every time.
fn scattered(n: u32) -> Vec<DVec2> {
    let unit = |i: u32| f64::from(polder_flip::priority(i)) / 2f64.powi(32);
    (0..n).map(|i| DVec2::new(unit(2 * i + 1), unit(2 * i + 2))).collect()
}
