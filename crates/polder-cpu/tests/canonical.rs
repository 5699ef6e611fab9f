//! The result is the canonical constrained Delaunay triangulation, by brute force.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_cpu::{CpuError, Delaunay};
use polder_mesh::{Chains, DVec2, GhostMesh, Monitor};
use polder_predicates::{Sign, must_flip, orient2d};
use proptest::prelude::*;

/// Checks that a mesh with ghosts is the canonical constrained Delaunay triangulation of its vertices.
fn check(mesh: &GhostMesh, at: &[DVec2]) {
    mesh.check().unwrap();
    let n = at.len();
    assert_eq!(mesh.slots(), (2 * n).saturating_sub(2));
    let mut seen = vec![false; n];
    for t in 0..mesh.slots() {
        for k in 0..3 {
            let h = (3 * t + k) as u32;
            let (a, b, c, d) = (mesh.origin(h), mesh.destination(h), mesh.apex(h), mesh.apex(mesh.twin(h)));
            let finite = [a, b, c, d].map(|v| (v as usize) < n);
            if finite[0] {
                seen[a as usize] = true;
            }
            if finite == [true, true, true, true] && !mesh.is_constrained(h) {
                let [a, b, c, d] = [a, b, c, d].map(|v| at[v as usize]);
                assert!(!must_flip(c, a, b, d), "an edge is not Delaunay: {a} {b}");
            }
            if finite[..3] == [true; 3] {
                assert_eq!(orient2d(at[a as usize], at[b as usize], at[c as usize]), Sign::Positive);
            }
            // Ghost edges: the hull turns left at each vertex, or goes straight on.
            if !finite[1] && finite[0] {
                let (u, v, w) = (at[d as usize], at[a as usize], at[c as usize]);
                assert_ne!(orient2d(u, v, w), Sign::Negative, "the hull is not convex at {v}");
            }
        }
    }
    assert!(n < 2 || seen.into_iter().all(|s| s), "a vertex is missing");
}

fn points(coordinates: &[(i32, i32)]) -> Vec<DVec2> {
    coordinates.iter().map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect()
}

fn crosses(p: [DVec2; 2], q: [DVec2; 2]) -> bool {
    let sides = |[a, b]: [DVec2; 2], c, d| {
        let (s, t) = (orient2d(a, b, c), orient2d(a, b, d));
        s != Sign::Zero && s == -t
    };
    sides(p, q[0], q[1]) && sides(q, p[0], p[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn points_on_a_small_lattice(size in 1i32..9, raw in prop::collection::vec((0i32..1000, 0i32..1000), 0..40)) {
        let raw: Vec<_> = raw.iter().map(|(x, y)| (x % size, y % size)).collect();
        let delaunay = Delaunay::new(&points(&raw), Monitor::default()).unwrap();
        let (mesh, at, _) = delaunay.to_ghost_mesh();
        check(&mesh, &at);
        for (i, &of) in delaunay.representatives().iter().enumerate() {
            prop_assert_eq!(of as usize, raw.iter().position(|p| *p == raw[i]).unwrap());
        }
    }

    #[test]
    fn constraints_on_a_small_lattice(
        size in 2i32..12,
        raw in prop::collection::vec((0i32..1000, 0i32..1000), 2..40),
        ends in prop::collection::vec((0usize..1000, 0usize..1000), 1..30),
    ) {
        let raw: Vec<_> = raw.iter().map(|(x, y)| (x % size, y % size)).collect();
        let input = points(&raw);
        let mut constraints: Vec<[u32; 2]> = Vec::new();
        for (a, b) in ends {
            let c = [(a % raw.len()) as u32, (b % raw.len()) as u32];
            let at = |c: [u32; 2]| c.map(|v| input[v as usize]);
            if constraints.iter().all(|&d| !crosses(at(c), at(d))) {
                constraints.push(c);
            }
        }
        let mut delaunay = Delaunay::new(&input, Monitor::default()).unwrap();
        let (chains, _) = delaunay.constrain(&constraints, Monitor::default()).unwrap();
        let (mesh, at, ids) = delaunay.to_ghost_mesh();
        check(&mesh, &at);
        let mut pieces = std::collections::BTreeSet::new();
        for (i, chain) in chains.iter().enumerate() {
            let [a, b] = constraints[i].map(|v| delaunay.representatives()[v as usize]);
            prop_assert_eq!([chain[0], chain[chain.len() - 1]], [a, b]);
            for pair in chain.windows(2) {
                pieces.insert([pair[0].min(pair[1]), pair[0].max(pair[1])]);
                prop_assert_eq!(orient2d(input[a as usize], input[b as usize], input[pair[1] as usize]), Sign::Zero);
            }
        }
        let mut marked = std::collections::BTreeSet::new();
        for h in 0..3 * mesh.slots() as u32 {
            if mesh.is_constrained(h) {
                let (a, b) = (ids[mesh.origin(h) as usize], ids[mesh.destination(h) as usize]);
                marked.insert([a.min(b), a.max(b)]);
            }
        }
        prop_assert_eq!(pieces, marked);
    }
}

#[test]
fn a_crossing_is_an_error() {
    let input = points(&[(0, 0), (4, 0), (4, 4), (0, 4)]);
    let mut delaunay = Delaunay::new(&input, Monitor::default()).unwrap();
    let result = delaunay.constrain(&[[0, 2], [1, 3]], Monitor::default());
    assert_eq!(result, Err(CpuError::Crossing { constraint: 1 }));
}

#[test]
fn no_points_one_point_and_points_on_a_line() {
    for n in 0..20 {
        let input: Vec<_> = (0..n).map(|i| DVec2::new(f64::from(i % 7), f64::from(i % 7) * 3.0)).collect();
        let mut delaunay = Delaunay::new(&input, Monitor::default()).unwrap();
        let constraints = if n > 6 { vec![[6, 0], [1, 1]] } else { vec![] };
        let (chains, _) = delaunay.constrain(&constraints, Monitor::default()).unwrap();
        if n > 6 {
            assert_eq!(chains.get(0), [6, 5, 4, 3, 2, 1, 0]);
            assert_eq!(chains.get(1), [1]);
        }
        let (mesh, at, _) = delaunay.to_ghost_mesh();
        check(&mesh, &at);
        assert!(delaunay.finish(chains).triangles().is_empty());
    }
}

#[test]
fn coordinates_of_any_magnitude() {
    for scale in [1e300, 1e-300, 5e-324, 1e308] {
        let input: Vec<_> = (0..200)
            .map(|i| DVec2::new(f64::from(i * 37 % 64) / 64.0, f64::from(i * 61 % 59) / 64.0) * scale)
            .collect();
        let delaunay = Delaunay::new(&input, Monitor::default()).unwrap();
        let (mesh, at, _) = delaunay.to_ghost_mesh();
        check(&mesh, &at);
        drop(delaunay.finish(Chains::default()));
    }
}
