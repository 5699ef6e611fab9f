//! The families that all other tests draw on: what they promise, checked by brute force.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_mesh::{DVec2, Triangulation};
use polder_predicates::{Sign, orient2d};
use polder_tests::{canonical_digest, classes, constrained_families, families, shuffled};

/// Whether two constraints cross in the interior of both.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let apart = |a, b, c, d| {
        let sides = [orient2d(a, b, c), orient2d(a, b, d)];
        sides == [Sign::Positive, Sign::Negative] || sides == [Sign::Negative, Sign::Positive]
    };
    apart(a, b, c, d) && apart(c, d, a, b)
}

#[test]
fn constraints_of_the_families_do_not_cross() {
    for seed in 0..3 {
        for (name, pslg) in constrained_families(500, seed) {
            assert!(!pslg.constraints().is_empty(), "{name}");
            let ends: Vec<_> = pslg.constraints().iter().map(|c| c.map(|v| pslg.points()[v as usize])).collect();
            for (i, &s) in ends.iter().enumerate() {
                let other = ends[..i].iter().position(|&t| cross(s, t));
                assert_eq!(other, None, "{name}, seed {seed}: constraint {i}");
            }
        }
    }
}

#[test]
fn families_exist_at_any_size() {
    for n in [0, 1, 2, 3, 4, 5, 17, 100] {
        for (name, pslg) in families(n, 1) {
            assert!(pslg.points().len() <= 2 * n + 5, "{name} {n}");
        }
    }
}

#[test]
fn a_shuffle_can_be_mapped_back() {
    let pslg = polder_io::generate::crowd(50, 1);
    let other = shuffled(&pslg, 9);
    for (new, &old) in other.points.iter().enumerate() {
        assert_eq!(other.pslg.points()[new], pslg.points()[old as usize]);
    }
    // Three distinct points make the one triangle that both know.
    let classes = classes(&pslg);
    let mut distinct: Vec<u32> = classes.clone();
    distinct.sort_unstable();
    distinct.dedup();
    let triangle = [distinct[2], distinct[0], distinct[1]];
    let there = triangle.map(|v| other.points.iter().position(|&old| classes[old as usize] == v).unwrap() as u32);
    let mesh = Triangulation::from_triangles(50, &[there]).unwrap();
    assert_eq!(other.digest_back(&mesh), canonical_digest(&pslg, &[triangle]));
}
