//! Insertion against the definition, and the claims of [QCT] section 4.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "common/bad_case.rs"]
mod bad_case;
mod common;
#[path = "common/diagonals.rs"]
mod diagonals;

use common::*;
use glam::DVec2;
use polder_constrain::reference::{self, Insertion, Trial, triangle_chain};
use polder_constrain::{ConstrainError, InsertReport};
use polder_flip::reference::{flip, sweep};
use polder_mesh::GhostMesh;
use proptest::prelude::*;

/// Some triangulation that is not Delaunay in general, a different one for each seed.
fn some_mesh(positions: &[DVec2], seed: u32) -> GhostMesh {
    let (mut mesh, _) = sweep(positions).unwrap();
    let mut active = polder_flip::reference::Active::all(&mesh);
    for _ in 0..seed % 5 {
        polder_flip::reference::flip_round(&mut mesh, positions, &mut active);
    }
    mesh
}

/// With another number of triangles of the longest chain that is rebuilt; by flips alone with 0.
fn insert_with(longest: u32, mesh: &mut GhostMesh, positions: &[DVec2], subs: &[[u32; 2]]) -> InsertReport {
    let mut insertion = Insertion::new(mesh, positions, subs).unwrap();
    insertion.set_longest_rebuilt(longest);
    while !insertion.is_done() {
        insertion.outer_round().unwrap();
    }
    insertion.report()
}

fn insert_all(longest: u32, mesh: &mut GhostMesh, positions: &[DVec2], constraints: &[[u32; 2]]) -> InsertReport {
    let walk = reference::walk(mesh, positions, constraints).unwrap();
    let report = insert_with(longest, mesh, positions, &walk.sub_constraints);
    assert_eq!(report.intersections, Some(walk.intersections()));
    assert_eq!(constrained_edges(mesh), walk.sub_constraints);
    report
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn makes_every_sub_constraint_an_edge((positions, constraints) in grid(8, 60, 40), seed: u32) {
        let mut mesh = some_mesh(&positions, seed);
        insert_all(seed % 12, &mut mesh, &positions, &constraints);
        prop_assert_eq!(check_triangulation(&mesh, &positions), Ok(()));
        flip(&mut mesh, &positions).unwrap();
        prop_assert_eq!(check_delaunay(&mesh, &positions), Ok(()));
    }

    /// The result does not depend on the triangulation at the start, the order and direction of the constraints, the
    /// number of inner rounds, which chains are rebuilt, or whether it was made Delaunay before.
    #[test]
    fn one_result_from_everywhere((positions, constraints) in grid(7, 50, 30), seed: u32) {
        let mut first = delaunay(&positions);
        reference::constrain(&mut first, &positions, &constraints, 10).unwrap();
        let expected = canonical(&first, &positions);

        let mut second = some_mesh(&positions, seed);
        let mut shuffled = constraints.clone();
        shuffled.sort_by_key(|c| polder_flip::priority(c[0].wrapping_mul(977) ^ c[1] ^ seed));
        for (i, c) in shuffled.iter_mut().enumerate() {
            if polder_flip::priority(i as u32 ^ seed).is_multiple_of(2) {
                c.reverse();
            }
        }
        let walk = reference::walk(&second, &positions, &shuffled).unwrap();
        let mut insertion = Insertion::new(&mut second, &positions, &walk.sub_constraints).unwrap();
        insertion.set_inner_rounds(1 + seed % 12);
        insertion.set_longest_rebuilt(seed / 12 % 12);
        while !insertion.is_done() {
            insertion.outer_round().unwrap();
        }
        flip(&mut second, &positions).unwrap();
        prop_assert_eq!(canonical(&second, &positions), expected);
    }

    /// Claim 1: with every flip for one constraint (length of its chain, number in base 3) falls.
    #[test]
    fn claim_1_length_and_number_fall((positions, constraints) in grid(12, 70, 4), seed: u32) {
        let mut mesh = some_mesh(&positions, seed);
        let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
        for s in &walk.sub_constraints {
            let one = std::slice::from_ref(s);
            follow(&mut mesh, &positions, one, Trial { single_file: true, ..Trial::default() }).map_err(TestCaseError::fail)?;
        }
        prop_assert_eq!(check_triangulation(&mesh, &positions), Ok(()));
    }

    /// Claim 2: k triangles cost at most a number of flips that is quadratic in k. Claim 3: all flips together are at most
    /// quadratic in the number of points.
    #[test]
    fn claims_2_and_3_flips_are_quadratic_at_most((positions, constraints) in grid(20, 120, 30), seed: u32) {
        let mut mesh = some_mesh(&positions, seed);
        let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
        let mut together = 0;
        for s in &walk.sub_constraints {
            let k = triangle_chain(&mesh, &positions, *s).unwrap().triangles.len() as u64;
            let report = insert_with(0, &mut mesh, &positions, std::slice::from_ref(s));
            prop_assert!(report.flips[0] <= k && report.flips[1] <= k, "{report}");
            prop_assert!(report.flips[2] <= k * k / 2, "{k}: {report}");
            together += report.all_flips();
        }
        let n = positions.len() as u64;
        prop_assert!(together <= n * n);
    }
}

/// Inserts one sub-constraint flip by flip, and says so if (length, number) does not fall.
fn follow(mesh: &mut GhostMesh, positions: &[DVec2], one: &[[u32; 2]], trial: Trial) -> Result<u32, String> {
    let mut insertion = Insertion::new(mesh, positions, one).unwrap();
    insertion.set_trial(trial);
    insertion.set_longest_rebuilt(0);
    insertion.mark().unwrap();
    let measure = |i: &Insertion<'_>| triangle_chain(i.mesh(), positions, one[0]).unwrap().measure();
    let mut before = measure(&insertion);
    let mut risen = 0;
    while !insertion.is_done() {
        if insertion.inner_round().unwrap() == 0 {
            return Err(format!("no pair is flippable, at {before:?}"));
        }
        let after = measure(&insertion);
        if after >= before {
            return Err(format!("from {before:?} to {after:?}"));
        }
        // The number alone, as a number: leading zeros count for nothing.
        let number = |digits: &[u8]| {
            let digits: Vec<u8> = digits.iter().copied().skip_while(|d| *d == 0).collect();
            (digits.len(), digits)
        };
        risen += u32::from(number(&after.1) > number(&before.1));
        before = after;
    }
    Ok(risen)
}

/// The paper says that the number alone falls; it can rise at a flip of case 1, which makes the chain shorter.
#[test]
fn claim_1_needs_the_length() {
    let single = Trial { single_file: true, ..Trial::default() };
    let risen: u32 = (0..60)
        .map(|seed| {
            let positions = uniform(100, seed);
            let mut mesh = some_mesh(&positions, seed);
            let walk = reference::walk(&mesh, &positions, &[[0, 1], [2, 3]]).unwrap();
            follow(&mut mesh, &positions, &walk.sub_constraints[..1], single).unwrap()
        })
        .sum();
    assert!(risen > 0);
}

/// Claim 1 without the look at what lies before: flips that make nothing smaller.
#[test]
fn claim_1_needs_the_look_ahead() {
    let blind = Trial { single_file: true, blind: true };
    let mut failed = 0;
    for seed in 0..60 {
        let positions = uniform(100, seed);
        let mut mesh = some_mesh(&positions, seed);
        failed += u32::from(follow(&mut mesh, &positions, &[[0, 1]], blind).is_err());
    }
    assert!(failed >= 10, "{failed}");
}

/// Claims 2 and 3 without it: flips back and forth, past any bound.
#[test]
fn claims_2_and_3_need_the_look_ahead() {
    let mut failed = [0; 2];
    for seed in 0..60 {
        let positions = uniform(100, seed);
        let mut mesh = some_mesh(&positions, seed);
        let k = triangle_chain(&mesh, &positions, [0, 1]).unwrap().triangles.len() as u64;
        let mut insertion = Insertion::new(&mut mesh, &positions, &[[0, 1]]).unwrap();
        insertion.set_trial(Trial { blind: true, single_file: true });
        insertion.set_longest_rebuilt(0);
        insertion.mark().unwrap();
        while !insertion.is_done() && insertion.report().all_flips() <= 100 * 100 {
            insertion.inner_round().unwrap();
        }
        failed[0] += u32::from(insertion.report().all_flips() > k * k);
        failed[1] += u32::from(insertion.report().all_flips() > 100 * 100);
    }
    assert!(failed[0] > 5 && failed[1] > 5, "{failed:?}");
}

#[test]
fn the_bad_case_for_any_k() {
    for k in [1, 2, 3, 5, 10, 25, 50, 100, 200, 1000] {
        let (mut mesh, positions, ends) = bad_case::bad_mesh(k);
        check_triangulation(&mesh, &positions).unwrap();
        let chain = triangle_chain(&mesh, &positions, ends).unwrap();
        assert_eq!(chain.to_string(), format!("0{}{}0", "2".repeat(2 * k - 1), "1".repeat(4 * k)));
        let length = chain.triangles.len() as u64;
        let report = insert_with(0, &mut mesh, &positions, &[ends]);
        check_triangulation(&mesh, &positions).unwrap();
        assert_eq!(constrained_edges(&mesh), [ends]);
        // It is bad: quadratic in flips by case 3, linear in rounds; and no worse than that.
        let k = k as u64;
        assert!(k < 5 || report.flips[2] >= k * k, "{report}");
        assert!(report.all_flips() <= length * length && report.inner_rounds <= 4 * length, "{report}");
    }
}

#[test]
fn crossing_constraints_are_an_error_before_any_flip() {
    let positions = points(&[(0, 0), (4, 0), (4, 4), (0, 4), (2, 1)]);
    let mut mesh = delaunay(&positions);
    let before = mesh.clone();
    let error = reference::constrain(&mut mesh, &positions, &[[0, 2], [1, 3]], 10).unwrap_err();
    assert_eq!(error.to_string(), "1 pairs of constraints cross, the first are 0 and 1");
    assert!(matches!(error, ConstrainError::CrossingConstraints(_)));
    assert_eq!(mesh, before);
    let error = reference::insert(&mut mesh, &positions, &[[0, 2], [1, 3]]).unwrap_err();
    assert!(matches!(error, ConstrainError::Blocked { .. }), "{error}");
    let positions = points(&[(0, 0), (1, 0), (2, 0), (1, 1)]);
    let mut mesh = delaunay(&positions);
    let error = reference::insert(&mut mesh, &positions, &[[0, 2]]).unwrap_err();
    assert_eq!(error, ConstrainError::ThroughVertex { sub_constraint: [0, 2], vertex: 1 });
    let error = reference::insert(&mut mesh, &positions, &[[0, 1], [2, 2]]).unwrap_err();
    assert_eq!(error, ConstrainError::NotAVertex { constraint: 1, vertex: 2 });
}

/// Constrained edges stay, and so one of two that cross ends as blocked, whatever the order.
#[test]
fn crossing_constraints_never_go_in_unnoticed() {
    let mut met = [0; 2];
    for seed in 0..400 {
        let positions = uniform(100, seed);
        let mesh = delaunay(&positions);
        let constraints = diagonals::with_diagonals(&mesh, &positions, [0, 99]);
        let walk = reference::walk(&mesh, &positions, &constraints).unwrap();
        if reference::crossings(&mesh, &positions, &walk, 1).unwrap().pairs.is_empty() {
            continue;
        }
        let mut subs = walk.sub_constraints;
        for turn in 0..4 {
            let mut mesh = mesh.clone();
            let mut insertion = Insertion::new(&mut mesh, &positions, &subs).unwrap();
            insertion.set_inner_rounds(1 + turn);
            insertion.set_longest_rebuilt(3 * (turn % 2));
            let mut edges = Vec::new();
            let error = loop {
                assert!(!insertion.is_done(), "{seed}, turn {turn}");
                let walks = insertion.report().outer_rounds;
                if let Err(error) = insertion.outer_round() {
                    met[(insertion.report().outer_rounds - walks) as usize] += 1;
                    break error;
                }
                let now = constrained_edges(insertion.mesh());
                assert!(edges.iter().all(|edge| now.contains(edge)), "{seed}, turn {turn}");
                edges = now;
            };
            assert!(matches!(error, ConstrainError::Blocked { .. }), "{seed}, turn {turn}: {error}");
            subs.rotate_left(1);
        }
    }
    assert!(met[0] > 1000 && met[1] > 40, "{met:?}, on walks and by flips");
}

/// A mesh that is no triangulation (its vertices moved after it was built) ends with a result or an error, never in a
/// panic or an endless loop.
#[test]
fn a_tangled_mesh_comes_to_an_end() {
    let mut errors = [0; 2];
    for seed in 0..300 {
        let mut mesh = some_mesh(&uniform(40, seed), seed);
        let tangled = uniform(40, seed + 1000);
        let constraints: Vec<[u32; 2]> = (0..8).map(|i| [i, 39 - i]).collect();
        match reference::walk(&mesh, &tangled, &constraints) {
            Ok(walk) => drop(reference::crossings(&mesh, &tangled, &walk, 10)),
            Err(error) => {
                assert!(matches!(error, ConstrainError::Lost { .. }), "{error}");
                errors[0] += 1;
            }
        }
        errors[1] += u32::from(reference::insert(&mut mesh, &tangled, &constraints[..1 + seed as usize % 8]).is_err());
        mesh.check().unwrap();
    }
    assert!(errors.iter().all(|&n| n > 100), "{errors:?}");
}

/// The chain of one constraint in digits, what was done, and the mesh before and after.
#[test]
fn text_forms() {
    let positions = points(&[(0, 0), (12, 0), (2, 3), (5, 2), (8, 3), (3, -3), (6, -2), (9, -3)]);
    let mut mesh = delaunay(&positions);
    let walk = reference::walk(&mesh, &positions, &[[1, 0], [3, 4]]).unwrap();
    let mut text = format!("{mesh}\n{walk}\n");
    let mut insertion = Insertion::new(&mut mesh, &positions, &walk.sub_constraints).unwrap();
    insertion.set_longest_rebuilt(0);
    insertion.mark().unwrap();
    while !insertion.is_done() {
        text += &format!("chain {}\n", triangle_chain(insertion.mesh(), &positions, [0, 1]).unwrap());
        insertion.inner_round().unwrap();
    }
    text += &format!("{}\n\n", insertion.report());
    let report = flip(&mut mesh, &positions).unwrap();
    insta::assert_snapshot!(format!("{text}{mesh}flipped: {report}"));
}
