//! Chains and crossings against brute force over all pairs.
#![allow(clippy::unwrap_used, reason = "tests")]

use glam::DVec2;
use polder_constrain::{ConstrainError, Crossings, Walk, reference};
use polder_flip::reference::{flip, sweep};
use polder_mesh::GhostMesh;
use polder_predicates::{Sign, lexicographic, orient2d};
use proptest::prelude::*;

fn points(list: &[(i32, i32)]) -> Vec<DVec2> {
    list.iter().map(|&(x, y)| DVec2::new(x.into(), y.into())).collect()
}

fn distinct(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| lexicographic(*a, *b));
    points.dedup();
    points
}

fn delaunay(positions: &[DVec2]) -> GhostMesh {
    let (mut mesh, _) = sweep(positions).unwrap();
    flip(&mut mesh, positions).unwrap();
    mesh
}

fn walk(positions: &[DVec2], constraints: &[[u32; 2]]) -> Walk {
    reference::walk(&delaunay(positions), positions, constraints).unwrap()
}

/// The vertices on a segment, in order along it: by definition.
fn brute_chain(positions: &[DVec2], [a, b]: [u32; 2]) -> Vec<u32> {
    let (p, q) = (positions[a as usize], positions[b as usize]);
    if a == b {
        return vec![a];
    }
    let (low, high) = if lexicographic(p, q).is_lt() { (p, q) } else { (q, p) };
    let on =
        |r: DVec2| orient2d(p, q, r) == Sign::Zero && lexicographic(low, r).is_le() && lexicographic(r, high).is_le();
    let mut chain: Vec<u32> = (0..positions.len() as u32).filter(|&v| on(positions[v as usize])).collect();
    chain.sort_by(|&u, &v| lexicographic(positions[u as usize], positions[v as usize]));
    if low == q {
        chain.reverse();
    }
    chain
}

/// All pairs of pieces whose ends lie strictly on both sides of each other.
fn brute_crossings(positions: &[DVec2], constraints: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let chains: Vec<Vec<u32>> = constraints.iter().map(|&c| brute_chain(positions, c)).collect();
    let splits = |a: u32, b: u32, c: u32, d: u32| {
        let side = |v: u32| orient2d(positions[a as usize], positions[b as usize], positions[v as usize]);
        side(c) != Sign::Zero && side(c) == -side(d)
    };
    let mut pairs = Vec::new();
    for j in 0..chains.len() {
        for i in 0..j {
            let cross = |p: &[u32], q: &[u32]| splits(p[0], p[1], q[0], q[1]) && splits(q[0], q[1], p[0], p[1]);
            if chains[i].windows(2).any(|p| chains[j].windows(2).any(|q| cross(p, q))) {
                pairs.push([i as u32, j as u32]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

fn check_all(mesh: &GhostMesh, positions: &[DVec2], constraints: &[[u32; 2]]) -> Result<(), TestCaseError> {
    let walk = reference::walk(mesh, positions, constraints).unwrap();
    for (i, &c) in constraints.iter().enumerate() {
        prop_assert_eq!(walk.chains.get(i), &brute_chain(positions, c)[..]);
        let along: Vec<[u32; 2]> = walk.chains.get(i).windows(2).map(|p| [p[0].min(p[1]), p[0].max(p[1])]).collect();
        let named: Vec<[u32; 2]> = walk.pieces(i).iter().map(|&s| walk.sub_constraints[s as usize]).collect();
        prop_assert_eq!(along, named);
    }
    prop_assert!(walk.sub_constraints.windows(2).all(|w| w[0] < w[1]));
    let crossings = reference::crossings(mesh, positions, &walk, 1_000_000).unwrap();
    prop_assert_eq!(crossings, Crossings { pairs: brute_crossings(positions, constraints), truncated: false });
    Ok(())
}

fn input(side: i32, count: usize, segments: usize) -> impl Strategy<Value = (Vec<DVec2>, Vec<[u32; 2]>)> {
    let positions = prop::collection::vec((0..side, 0..side), 2..count).prop_map(|list| distinct(points(&list)));
    positions.prop_flat_map(move |positions| {
        let n = positions.len() as u32;
        (Just(positions), prop::collection::vec([0..n, 0..n], 0..segments))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    /// Small grids: most constraints run through vertices, along edges and over each other.
    #[test]
    fn small_grids((positions, constraints) in input(6, 30, 25)) {
        check_all(&delaunay(&positions), &positions, &constraints)?;
        check_all(&sweep(&positions).unwrap().0, &positions, &constraints)?;
    }

    /// Larger grids with few points: long walks, many crossings in one triangle, some of them at one point.
    #[test]
    fn few_points_many_crossings((positions, constraints) in input(30, 20, 60)) {
        check_all(&delaunay(&positions), &positions, &constraints)?;
        check_all(&sweep(&positions).unwrap().0, &positions, &constraints)?;
    }

    /// Points on one line, in any direction: no triangle, but chains.
    #[test]
    fn points_on_a_line(
        steps in prop::collection::vec(-40..40, 2..20),
        direction in (-3..4, -3..4),
        ends in prop::collection::vec([0..40u32, 0..40u32], 0..20),
    ) {
        prop_assume!(direction != (0, 0));
        let on_line: Vec<(i32, i32)> = steps.iter().map(|t| (t * direction.0, t * direction.1)).collect();
        let positions = distinct(points(&on_line));
        let n = positions.len() as u32;
        let constraints: Vec<[u32; 2]> = ends.iter().map(|c| c.map(|v| v % n)).collect();
        check_all(&delaunay(&positions), &positions, &constraints)?;
    }
}

proptest! {
    // Exact signs of numbers of such different sizes are slow.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(40) })]

    /// Random doubles over a wide range of magnitudes.
    #[test]
    fn mixed_magnitudes(
        list in prop::collection::vec((-1.0..1.0f64, -60..60i32, -1.0..1.0f64, -60..60i32), 5..25),
        ends in prop::collection::vec([0..25u32, 0..25u32], 1..30),
    ) {
        let positions = distinct(
            list.iter().map(|&(x, i, y, j)| DVec2::new(x * 2f64.powi(5 * i), y * 2f64.powi(5 * j))).collect(),
        );
        let n = positions.len() as u32;
        let constraints: Vec<[u32; 2]> = ends.iter().map(|c| c.map(|v| v % n)).collect();
        check_all(&delaunay(&positions), &positions, &constraints)?;
    }
}

/// Constraints that all cross each other give every pair, and the first ones when there are too many.
#[test]
fn two_thousand_that_all_cross() {
    let n = 2000u32;
    let mut positions = Vec::new();
    for i in 0..n {
        positions.push(DVec2::new(f64::from(i), 0.0));
        positions.push(DVec2::new(f64::from(n - i) + 0.25, 1e4 + f64::from(i * i % 1001) * 1e-3));
    }
    let constraints: Vec<[u32; 2]> = (0..n).map(|i| [2 * i, 2 * i + 1]).collect();
    let (mesh, _) = sweep(&positions).unwrap();
    let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
    let all = reference::crossings(&mesh, &positions, &walk, usize::MAX).unwrap();
    assert!(!all.truncated);
    assert_eq!(all.pairs.len(), (n * (n - 1) / 2) as usize);
    assert!(all.pairs.windows(2).all(|w| w[0] < w[1]));
    let some = reference::crossings(&mesh, &positions, &walk, 1_000_000).unwrap();
    assert!(some.truncated);
    assert_eq!(some.pairs.len(), 1_000_000);
    // 1414 * 1413 / 2 = 998,991 pairs lie below constraint 1414.
    assert!(some.pairs.iter().all(|&[i, j]| i < j && j <= 1414));
}

/// Where four hundred constraints do not cross and then each of four hundred more crosses them all, the first pairs are
/// found without a search of them all.
#[test]
fn the_first_pairs_of_too_many() {
    let n = 400u32;
    let at = |i: u32| f64::from(i) + 1.0;
    let mut positions = Vec::new();
    positions.extend((0..n).flat_map(|i| [DVec2::new(0.0, at(i)), DVec2::new(2000.0, at(i) + 0.5)]));
    positions.extend((0..n).flat_map(|i| [DVec2::new(at(i), 0.0), DVec2::new(at(i) + 0.25, 2000.0)]));
    let constraints: Vec<[u32; 2]> = (0..2 * n).map(|i| [2 * i, 2 * i + 1]).collect();
    let (mesh, _) = sweep(&positions).unwrap();
    let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
    for max in [0, 1, 100, 2500] {
        let some = reference::crossings(&mesh, &positions, &walk, max).unwrap();
        let mut first: Vec<[u32; 2]> = (0..max as u32).map(|p| [p % n, n + p / n]).collect();
        first.sort_unstable();
        assert_eq!(some, Crossings { pairs: first, truncated: true });
    }
}

/// Many parallel constraints through the same few triangles: no crossing, and no time for all pairs.
#[test]
fn parallel_ones_through_one_triangle() {
    let n = 1500u32;
    let mut positions = vec![DVec2::new(0.0, -1e6), DVec2::new(-1.0, 1e6), DVec2::new(1.0, 1e6)];
    for i in 0..n {
        positions.push(DVec2::new(-1e4, f64::from(i) - 750.0));
        positions.push(DVec2::new(1e4, f64::from(i) - 750.0));
    }
    let constraints: Vec<[u32; 2]> = (0..n).map(|i| [3 + 2 * i, 4 + 2 * i]).collect();
    let (mesh, _) = sweep(&positions).unwrap();
    let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
    let crossings = reference::crossings(&mesh, &positions, &walk, 1000).unwrap();
    assert_eq!(crossings, Crossings::default());
    let mut more = constraints.clone();
    more.push([0, 1]);
    let walk = reference::walk(&mesh, &positions, &more).unwrap();
    let crossings = reference::crossings(&mesh, &positions, &walk, 1_000_000).unwrap();
    assert_eq!(crossings.pairs.len(), n as usize);
}

/// Every diameter of a circle runs through its center: cut there, nothing crosses, and the center is not asked for all
/// its spokes each time.
#[test]
fn ten_thousand_diameters_through_one_vertex() {
    let n = 10_000;
    let mut positions = vec![DVec2::ZERO];
    for i in 0..n {
        let angle = std::f64::consts::PI * (f64::from(i) + 0.5) / f64::from(n);
        let p = DVec2::new(angle.cos(), angle.sin());
        positions.extend([p, -p]);
    }
    let (mut mesh, _) = sweep(&positions).unwrap();
    flip(&mut mesh, &positions).unwrap();
    let constraints: Vec<[u32; 2]> = (0..n as u32).map(|i| [2 * i + 1, 2 * i + 2]).collect();
    let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
    assert!(walk.chains.iter().enumerate().all(|(i, c)| c == [2 * i as u32 + 1, 0, 2 * i as u32 + 2]));
    assert_eq!(walk.sub_constraints.len(), 2 * n as usize);
    assert_eq!(reference::crossings(&mesh, &positions, &walk, 10).unwrap(), Crossings::default());
}

#[test]
fn bad_input_is_an_error() {
    let positions = points(&[(0, 0), (4, 0), (0, 4), (4, 4), (4, 4)]);
    let mesh = delaunay(&positions);
    let fails = |constraints: &[[u32; 2]]| reference::walk(&mesh, &positions, constraints).unwrap_err();
    assert_eq!(fails(&[[0, 1], [1, 4]]), ConstrainError::NotAVertex { constraint: 1, vertex: 4 });
    assert_eq!(fails(&[[9, 9]]), ConstrainError::NotAVertex { constraint: 0, vertex: 9 });
    assert_eq!(reference::walk(&mesh, &positions, &[[4, 4]]).unwrap().chains.get(0), [4]);
    let error = reference::walk(&mesh, &positions[..3], &[]).unwrap_err();
    assert!(matches!(error, ConstrainError::MissingPosition { vertex: 3, .. }));
    // One point, no mesh.
    assert_eq!(reference::walk(&GhostMesh::default(), &positions[..1], &[[0, 0]]).unwrap().chains.get(0), [0]);
    // A hull that is not convex: the walk leaves the mesh.
    let open = polder_flip::reference::chain(&[0, 1, 2]);
    assert_eq!(reference::walk(&open, &positions, &[[0, 2]]).unwrap_err(), ConstrainError::Lost { ends: [0, 2] });
}

#[test]
fn text_forms() {
    let positions = points(&[(0, 0), (6, 0), (0, 6), (6, 6), (3, 3), (3, 1), (2, 5)]);
    // Through the center, the same backwards, an overlap, an edge, zero length, and two that cross.
    let constraints = [[0, 3], [3, 0], [4, 3], [5, 4], [6, 6], [2, 1], [6, 5], [0, 6]];
    let mesh = delaunay(&positions);
    let walked = walk(&positions, &constraints);
    let crossing = [[0, 3], [6, 5], [2, 4], [6, 1], [0, 6], [2, 5]];
    let other = walk(&positions, &crossing);
    let pairs = |max| reference::crossings(&mesh, &positions, &other, max).unwrap();
    insta::assert_snapshot!(format!(
        "{mesh}\n{walked}\n{}\n{other}\nall crossings\n{}the first one\n{}",
        reference::crossings(&mesh, &positions, &walked, 9).unwrap(),
        pairs(9),
        pairs(1)
    ));
}
