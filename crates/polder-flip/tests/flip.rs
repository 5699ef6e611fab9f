//! What flips guarantee, checked by brute force.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::*;
use glam::DVec2;
use polder_flip::FlipError;
use polder_flip::reference::{self, Active};
use polder_mesh::{GHOST, GhostMesh};
use polder_predicates::{Sign, orient2d};
use proptest::prelude::*;

/// Lawson's flips one at a time, in an order drawn from `seed`.
fn flip_one_by_one(mesh: &mut GhostMesh, positions: &[DVec2], seed: u32) {
    for step in 0..1_000_000 {
        let illegal: Vec<u32> = (0..3 * mesh.slots() as u32)
            .filter(|&h| h < mesh.twin(h) && reference::is_illegal(mesh, positions, h))
            .collect();
        if illegal.is_empty() {
            return;
        }
        let pick = polder_flip::priority(seed ^ step) as usize % illegal.len();
        mesh.flip(illegal[pick]);
    }
    panic!("a million flips were not enough");
}

fn grid_points(side: i32, count: usize) -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec((0..side, 0..side), 3..count).prop_map(|list| distinct(points(&list)))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// Small grids: nearly every set has cocircular and collinear points.
    #[test]
    fn reaches_the_delaunay_triangulation(positions in grid_points(7, 40)) {
        let (mut mesh, _) = reference::sweep(&positions).unwrap();
        reference::flip(&mut mesh, &positions).unwrap();
        prop_assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
    }

    /// Neither the start nor the order of flips shows in the result.
    #[test]
    fn any_order_of_flips_ends_at_the_same_triangles(positions in grid_points(6, 25), seed: u32) {
        let (start, _) = reference::sweep(&positions).unwrap();
        let mut rounds = start.clone();
        reference::flip(&mut rounds, &positions).unwrap();
        let mut steps = start;
        flip_one_by_one(&mut steps, &positions, seed);
        prop_assert_eq!(canonical(&rounds, &positions), canonical(&steps, &positions));
    }

    /// Hull flips and finite flips mixed from a bare chain give what they give one after the other.
    #[test]
    fn a_chain_is_start_enough(positions in grid_points(8, 40)) {
        let order: Vec<u32> = (0..positions.len() as u32).collect();
        let mut mixed = reference::chain(&order);
        prop_assert!(mixed.check().is_ok());
        reference::flip(&mut mixed, &positions).unwrap();
        let (mut apart, _) = reference::sweep(&positions).unwrap();
        reference::flip(&mut apart, &positions).unwrap();
        prop_assert_eq!(canonical(&mixed, &positions), canonical(&apart, &positions));
    }

    /// The slots of the result are a pure function of the mesh: the order of the active list does not matter.
    #[test]
    fn the_order_of_the_list_does_not_matter(positions in grid_points(8, 40), seed: u32) {
        let (start, _) = reference::sweep(&positions).unwrap();
        let mut edges: Vec<u32> = (0..3 * start.slots() as u32).collect();
        let (mut forward, mut shuffled) = (start.clone(), start);
        let mut a = Active::all(&forward);
        edges.sort_by_key(|&h| polder_flip::priority(h ^ seed));
        let mut b = Active::new();
        edges.iter().for_each(|&h| b.push(h));
        while !a.is_empty() || !b.is_empty() {
            let flips = reference::flip_round(&mut forward, &positions, &mut a);
            prop_assert_eq!(flips, reference::flip_round(&mut shuffled, &positions, &mut b));
            prop_assert_eq!(&forward, &shuffled);
        }
        prop_assert_eq!(a.tests(), b.tests());
    }

    /// Constrained edges stay, whatever the in-circle test says of them, and everything else is legal.
    #[test]
    fn constrained_edges_are_never_flipped(positions in grid_points(8, 40), seed: u32) {
        let (mut mesh, _) = reference::sweep(&positions).unwrap();
        let mut kept = Vec::new();
        for h in 0..3 * mesh.slots() as u32 {
            let (a, b) = (mesh.origin(h), mesh.destination(h));
            if h < mesh.twin(h) && a != GHOST && b != GHOST && polder_flip::priority(h ^ seed).is_multiple_of(4) {
                mesh.set_constrained(h, true);
                kept.push([a.min(b), a.max(b)]);
            }
        }
        reference::flip(&mut mesh, &positions).unwrap();
        prop_assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
        let mut found: Vec<[u32; 2]> = (0..3 * mesh.slots() as u32)
            .filter(|&h| h < mesh.twin(h) && mesh.is_constrained(h))
            .map(|h| [mesh.origin(h).min(mesh.destination(h)), mesh.origin(h).max(mesh.destination(h))])
            .collect();
        found.sort_unstable();
        kept.sort_unstable();
        prop_assert_eq!(found, kept);
    }
}

/// The checks above can fail: a flipped edge, an edge wrongly spared.
#[test]
fn the_checker_notices_one_wrong_edge() {
    let positions = uniform(50, 7);
    let (mut mesh, _) = reference::sweep(&positions).unwrap();
    assert!(check_delaunay(&mesh, &positions).is_err());
    reference::flip(&mut mesh, &positions).unwrap();
    assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
    let inner = (0..3 * mesh.slots() as u32)
        .find(|&h| {
            let g = mesh.twin(h);
            let finite = mesh.is_finite((h / 3) as usize) && mesh.is_finite((g / 3) as usize);
            let at = |v: u32| positions[v as usize];
            let turns = |h: u32, g: u32| orient2d(at(mesh.apex(h)), at(mesh.origin(h)), at(mesh.apex(g)));
            finite && turns(h, g) == Sign::Positive && turns(g, h) == Sign::Positive
        })
        .unwrap();
    mesh.flip(inner);
    assert!(check_delaunay(&mesh, &positions).unwrap_err().contains("illegal"));
}

#[test]
fn without_a_triangle_there_is_nothing_to_do() {
    for n in 0..5 {
        let positions = points(&[(0, 0), (1, 0), (2, 0), (3, 0)])[..n.min(4)].to_vec();
        let (mut mesh, report) = reference::sweep(&positions).unwrap();
        assert_eq!((mesh.slots(), report.flips), (2 * positions.len().saturating_sub(1), 0));
        mesh.check().unwrap();
        assert_eq!(reference::flip(&mut mesh, &positions).unwrap().flips, 0);
    }
}

/// Of each unit square of a lattice the diagonal through its lower left corner stays.
#[test]
fn a_lattice_keeps_the_diagonal_at_the_least_corner() {
    let positions: Vec<DVec2> = (0..400).map(|i| DVec2::new((i % 20).into(), (i / 20).into())).collect();
    let (mut mesh, _) = reference::sweep(&positions).unwrap();
    reference::flip(&mut mesh, &positions).unwrap();
    assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
    assert_eq!(mesh.finite().count(), 2 * 19 * 19);
    for h in (0..3 * mesh.slots() as u32).filter(|&h| mesh.is_finite((h / 3) as usize)) {
        let d = positions[mesh.destination(h) as usize] - positions[mesh.origin(h) as usize];
        assert!(d.x * d.y >= 0.0, "a diagonal that falls: {d}");
    }
}

/// A row of squares, each with the wrong diagonal: all conflict with their neighbors' sides only, none twice.
#[test]
fn a_row_of_conflicts_takes_few_rounds() {
    // Points on two parallel lines, connected so that a long row of diagonals all want to flip at once.
    let n = 4000;
    let mut positions = Vec::new();
    for i in 0..n {
        positions.push(DVec2::new(f64::from(i), 0.0));
        positions.push(DVec2::new(f64::from(i) + 0.4, 1.0));
    }
    let (mut mesh, _) = reference::sweep(&positions).unwrap();
    let report = reference::flip(&mut mesh, &positions).unwrap();
    assert_eq!(check_delaunay(&mesh, &positions[..]), Ok(()));
    assert!(report.rounds < 40, "{report}");
}

/// Families that need many flips stay far from the bound on rounds.
#[test]
fn rounds_stay_far_from_their_bound() {
    let parabola = |n: i32| (0..n).map(|i| DVec2::new(f64::from(i), f64::from(i) * f64::from(i)));
    let facing = |n: i32| {
        let low = (0..n).map(|i| DVec2::new(f64::from(i) * 1.5, f64::from(i * i) / 1e4));
        let high = (0..n).map(|i| DVec2::new(f64::from(i) * 1.5 + 0.25, 1e3 - f64::from(i * i) / 1e4));
        low.chain(high)
    };
    for positions in [parabola(300).collect::<Vec<_>>(), facing(150).collect(), uniform(300, 3)] {
        let (mut mesh, closing) = reference::sweep(&positions).unwrap();
        let report = reference::flip(&mut mesh, &positions).unwrap();
        assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
        assert!(report.rounds <= mesh.slots() as u64, "{report}");
        assert!(closing.flips < mesh.slots() as u64, "{closing}");
    }
}

/// Every hull flip takes an edge off the hull, and a closed hull has nowhere a strictly reflex turn.
#[test]
fn the_hull_is_closed_by_ghost_flips_alone() {
    let positions = uniform(2000, 11);
    let (mesh, report) = reference::sweep(&positions).unwrap();
    let ghosts = (0..mesh.slots()).filter(|&t| mesh.is_ghost(t)).count() as u64;
    assert_eq!(report.flips, mesh.slots() as u64 - ghosts);
    for h in (0..3 * mesh.slots() as u32).filter(|&h| mesh.origin(h) == GHOST) {
        assert!(!reference::is_illegal(&mesh, &positions, h));
    }
    assert!(mesh.finite().count() > 3000);
}

#[test]
fn bad_input_is_an_error() {
    let positions = points(&[(0, 0), (4, 0), (1, 3), (4, 4)]);
    let (mut mesh, _) = reference::sweep(&positions).unwrap();
    let error = reference::flip(&mut mesh, &positions[..3]).unwrap_err();
    assert!(matches!(error, FlipError::MissingPosition { vertex: 3, positions: 3, .. }), "{error}");
}

/// A mesh that is no triangulation (its vertices moved after it was built) ends with a result or an error, never in a
/// panic or an endless loop.
#[test]
fn a_tangled_mesh_comes_to_an_end() {
    for seed in 0..40 {
        let (mut mesh, _) = reference::sweep(&uniform(60, seed)).unwrap();
        match reference::flip(&mut mesh, &uniform(60, seed + 1000)) {
            Ok(_) => {}
            Err(error) => assert!(matches!(error, FlipError::BoundExceeded { stage: "flip", .. }), "{error}"),
        }
        mesh.check().unwrap();
    }
}

#[test]
fn text_forms() {
    let positions = points(&[(0, 0), (2, 3), (3, -3), (4, 2), (6, 0), (3, 1)]);
    let (mut mesh, closing) = reference::sweep(&positions).unwrap();
    let before = mesh.to_string();
    let report = reference::flip(&mut mesh, &positions).unwrap();
    insta::assert_snapshot!(format!("{before}closed: {closing}\n\n{mesh}flipped: {report}"));
    assert!(report.flips > 0);
}
