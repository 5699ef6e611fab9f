//! Constraints by flips, on every family of inputs: one result, from whichever triangulation they start.
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod verify_support;

use constrain_support::Start;
use polder_constrain::{ConstrainError, reference};
use polder_io::generate;
use polder_mesh::Pslg;
use polder_tests::{canonical_digest, canonical_triangles, constrained_families, shuffled};
use std::time::Instant;
use verify_support::by_spade;

/// From stages 1 to 4, from the Delaunay triangulation, and after a shuffle of points and constraints.
fn one_result(name: &str, pslg: &Pslg, seed: u64) {
    let expected = Start::delaunay(pslg).constrained();
    let by_stages = Start::stage_4(pslg).constrained();
    assert!(expected == by_stages, "{name}: the triangulation at the start shows");
    let other = shuffled(pslg, seed);
    let back = other.digest_back(&Start::stage_4(&other.pslg).constrained());
    assert_eq!(back, canonical_digest(pslg, expected.triangles()), "{name}: the order of the input shows");

    // By the CPU's own way, one constraint after the other and without flips through.
    let mut cavities = polder_cpu::Delaunay::new(pslg.points(), Default::default()).unwrap();
    let (chains, _) = cavities.constrain(pslg.constraints(), Default::default()).unwrap();
    assert!(expected == cavities.finish(chains), "{name}: two ways, two triangulations");
}

#[test]
fn every_family_has_one_result() {
    for (n, seeds) in [(8, 6), (100, 4), (2000, 1)] {
        for seed in 0..seeds {
            for (name, pslg) in constrained_families(n, seed) {
                one_result(name, &pslg, seed);
            }
        }
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn every_large_family_has_one_result() {
    for (name, pslg) in constrained_families(100_000, 5) {
        if !name.contains("collinear") {
            one_result(name, &pslg, 5);
        }
    }
}

/// Spade, which inserts one constraint after the other, has the same triangles where no four points tie.
#[test]
fn spade_agrees() {
    for (points, constraints, seed) in [(300, 100, 1), (3000, 1500, 2), (20_000, 2000, 3)] {
        let pslg = generate::segments(points, constraints, seed);
        let theirs = canonical_triangles(&pslg, &by_spade(&pslg).unwrap());
        assert!(Start::stage_4(&pslg).constrained().triangles() == theirs, "{points} points");
    }
}

/// The mistakes that the comparison is there for are seen by it.
#[test]
fn a_missing_constraint_shows() {
    let pslg = generate::segments(300, 100, 1);
    let (points, mut constraints) = pslg.clone().into_parts();
    constraints.remove(17);
    let less = Pslg::new(points, constraints).unwrap();
    assert_ne!(Start::stage_4(&less).constrained().digest(), Start::stage_4(&pslg).constrained().digest());
}

fn many(fan: usize, through: usize, along: usize) {
    // Many constraints at one vertex: all walks of all rounds together are shorter than if each walked once at the beginning.
    let pslg = generate::fan(fan, 1);
    let mut start = Start::stage_4(&pslg);
    let (walk, insert, _) = reference::constrain(&mut start.mesh, &start.positions, &start.constraints, 100).unwrap();
    assert_eq!(walk.sub_constraints.len(), fan);
    assert!(3 * insert.walked < walk.intersections(), "{insert}, walked {}", insert.walked);
    let edges = (0..3 * start.mesh.slots() as u32).filter(|&h| h < start.mesh.twin(h) && start.mesh.is_constrained(h));
    assert_eq!(edges.count(), fan);

    // One constraint through many vertices.
    let pslg = generate::through_vertices(through, 2);
    let line = Start::stage_4(&pslg).constrained();
    assert_eq!(line.chains().get(0).len(), through + 2);

    for pslg in [generate::comb(along), generate::spiral(along)] {
        let mesh = Start::stage_4(&pslg).constrained();
        let edges = mesh.edges().filter(|e| e.constrained).count();
        assert_eq!(edges, along - 1);
    }
}

#[test]
fn fan_line_comb_and_spiral() {
    many(10_000, 10_000, 10_000);
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn fan_of_100_000() {
    many(100_000, 100_000, 100_000);
}

/// What crosses is the same in every triangulation, and nothing is inserted.
#[test]
fn crossings_do_not_depend_on_the_mesh() {
    for (constraints, length, seed) in [(100, 1.0, 1), (2000, 0.1, 2), (3000, 0.5, 3)] {
        let pslg = generate::crossing_segments(3 * constraints, constraints, length, seed);
        let [ours, theirs] = [Start::stage_4(&pslg), Start::delaunay(&pslg)].map(|mut start| {
            let before = start.mesh.clone();
            let result = reference::constrain(&mut start.mesh, &start.positions, &start.constraints, 20_000);
            assert!(start.mesh == before);
            match result {
                Err(ConstrainError::CrossingConstraints(crossings)) => crossings,
                other => panic!("{other:?}"),
            }
        });
        assert_eq!(ours, theirs);
        assert!(ours.pairs.len() > constraints / 2, "{}", ours.pairs.len());
    }
}

/// Ten million constraints that hardly cross: no time for pairs.
#[test]
#[ignore = "long: cargo xtask ci --long"]
fn crossings_of_ten_million() {
    let n = 10_000_000u32;
    let side = 3163u32;
    let (points, _) = generate::lattice(side as usize, side as usize).into_parts();
    // Every point to its right neighbor, and two that cross a few of them.
    let mut constraints: Vec<[u32; 2]> = (0..n).filter(|i| i % side != side - 1).map(|i| [i, i + 1]).collect();
    constraints.extend([[0, 2 * side + 1], [1, 2 * side]]);
    let pslg = Pslg::new(points, constraints).unwrap();
    let start = Start::delaunay(&pslg);
    let clock = Instant::now();
    let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
    let walked = clock.elapsed();
    let crossings = reference::crossings(&start.mesh, &start.positions, &walk, 1000).unwrap();
    println!("walk {walked:?}, crossings {:?}", clock.elapsed() - walked);
    assert_eq!(crossings.pairs.len(), 3, "{crossings}");
}
