//! Spade as the oracle: on every input that it takes, its mesh and ours have the same edges, but for the diagonals of
//! exactly cocircular corners.
#![allow(clippy::unwrap_used, reason = "tests")]

mod verify_support;

use polder::{Options, triangulate};
use polder_mesh::{EdgeId, Pslg, Triangulation};
use polder_predicates::{Sign, incircle};
use polder_tests::{canonical_triangles, classes, constrained_families, point_families};
use verify_support::by_spade;

/// The edges that every constrained Delaunay triangulation of the input has, sorted: all but those between two
/// triangles with one circumcircle. Constrained edges are found in the chains of ours, which holds for both meshes.
fn certain_edges(pslg: &Pslg, mesh: &Triangulation, constrained: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let at = |v: u32| pslg.points()[v as usize];
    let apex = |edge: EdgeId| mesh.triangles()[edge.triangle().index()][edge.k()];
    let mut edges = Vec::new();
    for edge in mesh.edges() {
        let [b, c] = edge.vertices.map(|v| v.0);
        let ends = [b.min(c), b.max(c)];
        let is_tie = mesh.twin(edge.id).is_some_and(|twin| {
            let [a, b, c, d] = [apex(edge.id), b, c, apex(twin)].map(at);
            incircle(a, b, c, d) == Sign::Zero
        });
        if !is_tie || constrained.binary_search(&ends).is_ok() {
            edges.push(ends);
        }
    }
    edges.sort_unstable();
    edges
}

fn pieces(mesh: &Triangulation) -> Vec<[u32; 2]> {
    let all = mesh.chains().iter().flat_map(|chain| chain.windows(2));
    let mut pieces: Vec<_> = all.map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]).collect();
    pieces.sort_unstable();
    pieces.dedup();
    pieces
}

/// Compares; says whether spade takes the input.
fn agree(name: &str, pslg: &Pslg) -> bool {
    let Some(theirs) = by_spade(pslg) else { return false };
    let ours = triangulate(pslg, &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}")).triangulation;
    let theirs = canonical_triangles(pslg, &theirs);
    assert_eq!(ours.triangles().len(), theirs.len(), "{name}");

    let theirs = Triangulation::from_triangles(pslg.points().len(), &theirs).unwrap();
    let constrained = pieces(&ours);
    let edges = certain_edges(pslg, &ours, &constrained);
    assert!(edges == certain_edges(pslg, &theirs, &constrained), "{name}: the edges differ");
    true
}

#[test]
fn delaunay_triangulations_agree() {
    let mut taken = 0;
    for (n, seeds) in [(3, 5), (10, 20), (100, 5), (2000, 1)] {
        for seed in 0..seeds {
            for (name, pslg) in point_families(n, seed) {
                // Near the smallest numbers that spade takes, its in-circle test underflows.
                taken += usize::from(name != "mixed magnitudes" && agree(name, &pslg));
            }
        }
    }
    assert!(taken > 31 * 18, "{taken}");
}

#[test]
fn constrained_delaunay_triangulations_agree() {
    let mut taken = 0;
    for (n, seeds) in [(10, 20), (100, 5), (2000, 1)] {
        for seed in 0..seeds {
            for (name, pslg) in constrained_families(n, seed) {
                taken += usize::from(agree(name, &pslg));
            }
        }
    }
    assert!(taken > 26 * 8, "{taken}");
}

#[test]
fn inputs_without_ties_have_the_same_triangles() {
    for pslg in [polder_io::generate::uniform(20_000, 8), polder_io::generate::segments(20_000, 2000, 9)] {
        let theirs = canonical_triangles(&pslg, &by_spade(&pslg).unwrap());
        let ours = triangulate(&pslg, &Options::default()).unwrap().triangulation;
        assert!(ours.triangles() == theirs, "the triangles differ");
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn large_triangulations_agree() {
    for (name, pslg) in point_families(200_000, 10).into_iter().chain(constrained_families(200_000, 11)) {
        // Spade takes quadratic time where all points lie on one line.
        if name != "mixed magnitudes" && !name.contains("collinear") {
            agree(name, &pslg);
        }
    }
    for pslg in [polder_io::generate::uniform(1_000_000, 12), polder_io::generate::segments(1_000_000, 100_000, 13)] {
        assert!(agree("a million", &pslg));
    }
}

#[test]
fn duplicates_are_told_apart_as_spade_does() {
    for (name, pslg) in point_families(500, 14) {
        let vertices = triangulate(&pslg, &Options::default()).unwrap().triangulation.vertices().count();
        let mut distinct = classes(&pslg);
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(vertices, distinct.len(), "{name}");
    }
}
