//! Properties on which the proof of the shift rests, and its counts.

use crate::common::{Random, lattice_points, phases};
use polder_dualize::{DVec2, DualizeError, reference};
use polder_flip::reference::close_hull;
use polder_mesh::GhostMesh;
use polder_predicates::{Sign, orient2d};
use polder_voronoi::{Options, Resolution};
use proptest::prelude::*;

/// A dualized mesh with its pixel centers and true positions.
struct Grid {
    mesh: GhostMesh,
    centers: Vec<DVec2>,
    positions: Vec<DVec2>,
}

fn grid(random: &mut Random) -> Grid {
    let n = 3 + random.below(60) as usize;
    let points: Vec<DVec2> = match random.below(3) {
        0 => (0..n).map(|_| random.point()).collect(),
        1 => lattice_points(random, n, 20, 6),
        _ => (0..n).map(|_| DVec2::from_angle(7.0 * random.unit())).collect(),
    };
    let resolution = Resolution::PixelsPerPoint(1.0 + 9.0 * random.unit());
    let voronoi = polder_voronoi::reference::diagram(&points, &Options::from(resolution)).unwrap();
    let sites = &voronoi.sites;
    let centers = sites.pixels[..sites.count].iter().map(|&p| voronoi.mapping.center(p.map(u32::from))).collect();
    let positions = sites.order[..sites.count].iter().map(|&i| points[i as usize]).collect();
    Grid { mesh: reference::dualize(&voronoi.diagram, sites).unwrap().mesh, centers, positions }
}

/// Each site at its center or its true position.
fn mixed(grid: &Grid, random: &mut Random, share: u64) -> Vec<DVec2> {
    let either = |(&c, &p)| if random.below(8) < share { p } else { c };
    grid.centers.iter().zip(&grid.positions).map(either).collect()
}

fn all_counterclockwise(mesh: &GhostMesh, at: &[DVec2]) -> bool {
    mesh.finite().all(|t| {
        let [a, b, c] = mesh.triangles[t].map(|v| at[v as usize]);
        orient2d(a, b, c) == Sign::Positive
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// The lemma: in any mixed position, between any two sites, the signs of dx and dy are kept where they are not
    /// zero, and so the turn is less than a right angle.
    #[test]
    fn edges_turn_by_less_than_a_right_angle(seed: u64) {
        let random = &mut Random::new(seed);
        let grid = grid(random);
        let at = mixed(&grid, random, 4);
        let sign = |x: f64, y: f64| x.partial_cmp(&y).map(|o| o as i32).unwrap();
        for i in 0..at.len() {
            for j in 0..i {
                let before = [0, 1].map(|k| sign(grid.centers[j][k], grid.centers[i][k]));
                let after = [0, 1].map(|k| sign(at[j][k], at[i][k]));
                prop_assert!([0, 1].iter().all(|&k| before[k] == 0 || before[k] == after[k]));
                prop_assert!(before[0] * after[0] + before[1] * after[1] > 0);
            }
        }
    }

    /// The claim: in every mixed position with all finite triangles counterclockwise, ghost flips make a triangulation.
    #[test]
    fn counterclockwise_mixed_positions_close_to_a_triangulation(seed: u64) {
        let random = &mut Random::new(seed);
        let grid = grid(random);
        for share in 0..=8 {
            let at = mixed(&grid, random, share);
            if all_counterclockwise(&grid.mesh, &at) {
                let mut mesh = grid.mesh.clone();
                close_hull(&mut mesh, &at).unwrap();
                prop_assert_eq!(reference::certify(&mesh, &at, "test"), Ok(()));
            }
        }
    }

    /// What is left stands at its true position, and everything taken out has an heir that is left.
    #[test]
    fn shifted_sites_stand_at_their_true_positions(seed: u64) {
        let grid = grid(&mut Random::new(seed));
        let shifted = reference::shift(grid.mesh, &grid.centers, &grid.positions).unwrap();
        shifted.mesh.check().unwrap();
        prop_assert_eq!(reference::certify(&shifted.mesh, &grid.positions, "test"), Ok(()));
        let there = shifted.mesh.half_edge_of_vertex(grid.centers.len());
        for (v, &heir) in shifted.heirs.iter().enumerate() {
            let is_there = there[v] != polder_mesh::NONE;
            prop_assert_eq!(is_there, heir as usize == v);
            prop_assert!(shifted.mesh.slots() == 0 || there[heir as usize] != polder_mesh::NONE);
        }
        prop_assert!(shifted.taken_out().count() == shifted.stuck || shifted.mesh.slots() == 0);
    }
}

#[test]
fn few_sites_are_pinned_and_fewer_taken_out() {
    let mut random = Random::new(1);
    let points: Vec<DVec2> = (0..20_000).map(|_| random.point()).collect();
    let phases = phases(&points);
    let shifted = &phases.shifted;
    let sites = phases.voronoi.sites.count;
    assert!(shifted.bad < sites / 15, "{} of {sites}", shifted.bad);
    assert!(shifted.stuck < shifted.bad * 2 / 5, "{} of {}", shifted.stuck, shifted.bad);
    assert!(shifted.rounds.iter().sum::<u64>() < 20, "{:?}", shifted.rounds);
    assert!(phases.inserted.rounds <= 6);
}

/// Positions that do not belong to the centers: nearly everything is taken out, or there is an error, but never a wrong
/// mesh.
#[test]
fn positions_in_another_order_give_a_triangulation_or_an_error() {
    let mut random = Random::new(2);
    let mut refused = 0;
    for _ in 0..200 {
        let grid = grid(&mut random);
        let n = grid.positions.len();
        let wrong: Vec<DVec2> = (0..n).map(|i| grid.positions[(i * 7 + 3) % n]).collect();
        match reference::shift(grid.mesh, &grid.centers, &wrong) {
            Ok(shifted) => assert_eq!(reference::certify(&shifted.mesh, &wrong, "test"), Ok(())),
            Err(
                DualizeError::NotCounterclockwise { .. }
                | DualizeError::HullNotConvex { .. }
                | DualizeError::HullWinds { .. },
            ) => refused += 1,
            Err(other) => panic!("{other}"),
        }
    }
    assert!(refused > 0);
}
