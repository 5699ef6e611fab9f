//! The checker accepts what is right: meshes of spade, small ones drawn by hand, and ours.
#![allow(clippy::unwrap_used, reason = "tests")]

mod verify_support;

use polder::verify::{self, Kind};
use polder_mesh::Pslg;
use polder_tests::{constrained_families, families, point_families};
use verify_support::{by_spade, pslg};

fn accept(name: &str, pslg: &Pslg, triangles: &[[u32; 3]]) {
    let verdict = verify::check(pslg, triangles);
    assert!(verdict.is_valid(), "{name}: {verdict}");
    assert!(verdict.problems().iter().all(|problem| problem.kind.is_harmless()), "{name}: {verdict}");
}

#[test]
fn delaunay_triangulations_of_spade_are_accepted() {
    for n in [3, 10, 300, 3000] {
        for (name, pslg) in point_families(n, 1) {
            // Near the smallest numbers that it takes, spade's in-circle test underflows.
            if name == "mixed magnitudes" {
                continue;
            }
            if let Some(triangles) = by_spade(&pslg) {
                accept(name, &pslg, &triangles);
            }
        }
    }
}

#[test]
fn constrained_delaunay_triangulations_of_spade_are_accepted() {
    let mut taken = 0;
    for n in [10, 300, 3000] {
        for (name, pslg) in constrained_families(n, 2) {
            if let Some(triangles) = by_spade(&pslg) {
                accept(name, &pslg, &triangles);
                taken += 1;
            }
        }
    }
    assert!(taken > 20, "{taken}");
}

#[test]
fn twenty_thousand_points_of_spade_are_accepted() {
    for pslg in [polder_io::generate::uniform(20_000, 3), polder_io::generate::segments(20_000, 4000, 4)] {
        accept("20,000 points", &pslg, &by_spade(&pslg).unwrap());
    }
}

#[test]
fn inputs_without_a_triangle_have_an_empty_mesh() {
    let few = [
        pslg(&[], &[]),
        pslg(&[(1.0, 2.0)], &[[0, 0]]),
        pslg(&[(1.0, 2.0), (3.0, 4.0)], &[[0, 1]]),
        pslg(&[(1.0, 1.0), (1.0, 1.0), (1.0, 1.0)], &[]),
        pslg(&[(0.0, 0.0), (3.0, 3.0), (1.0, 1.0), (3.0, 3.0)], &[[0, 1], [1, 2]]),
    ];
    for pslg in few {
        assert!(verify::check(&pslg, &[]).is_canonical());
    }
}

#[test]
fn either_of_two_equal_points_may_serve() {
    let points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, -0.0)];
    let pslg = pslg(&points, &[[3, 2], [1, 3]]);
    assert!(verify::check(&pslg, &[[0, 1, 2]]).is_canonical());

    let verdict = verify::check(&pslg, &[[0, 3, 2]]);
    assert!(verdict.is_valid() && !verdict.is_canonical(), "{verdict}");
    assert_eq!(verdict.totals(), [(Kind::HigherName, 1)]);
}

#[test]
fn a_hub_of_many_constraints_is_read_in_every_direction() {
    for (name, pslg) in [("fan", polder_io::generate::fan(2000, 1)), ("star", star(400))] {
        accept(name, &pslg, &by_spade(&pslg).unwrap());
    }
}

/// Constraints through one vertex in the middle, from rim to rim, each through two more vertices.
fn star(n: u32) -> Pslg {
    let mut points = vec![(0.0, 0.0)];
    let mut constraints = Vec::new();
    for i in 0..n {
        let (x, y) = (f64::from(i) - f64::from(n / 2), f64::from(n));
        constraints.push([points.len() as u32, points.len() as u32 + 1]);
        points.extend([(4.0 * x, 4.0 * y), (-4.0 * x, -4.0 * y), (x, y), (-x, -y)]);
    }
    pslg(&points, &constraints)
}

#[test]
fn triangulations_of_ours_are_accepted_and_canonical() {
    for n in [0, 1, 2, 3, 4, 30, 1000] {
        for (name, pslg) in families(n, 5) {
            ours(name, &pslg);
        }
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn large_triangulations_of_ours_are_accepted_and_canonical() {
    // 50,000 constraints of 100,000 collinear points each have chains that fill no memory of today.
    for (name, pslg) in families(200_000, 6).into_iter().filter(|(name, _)| *name != "collinear with constraints") {
        ours(name, &pslg);
    }
    ours("ten million", &polder_io::generate::uniform(10_000_000, 7));
}

fn ours(name: &str, pslg: &Pslg) {
    let output = polder::triangulate(pslg, &polder::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    let verdict = verify::check_triangulation(pslg, &output.triangulation);
    assert!(verdict.is_canonical(), "{name}, {} points: {verdict}", pslg.points().len());
}
