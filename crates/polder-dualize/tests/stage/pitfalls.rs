//! What a first attempt at these stages stumbles over, each under its name.

use crate::common::{Random, by_sweep, finish, lattice_points, phases, phases_with};
use polder_dualize::DVec2;
use polder_dualize::reference::{self, Phases};
use polder_mesh::{GHOST, GhostMesh, NONE};
use polder_voronoi::{Options, Resolution};

/// All stages, and the same triangles in the end as another way gives.
fn right(points: &[DVec2], resolution: Resolution) -> Phases {
    let phases = phases_with(points, &Options::from(resolution));
    assert_eq!(finish(points, &phases), by_sweep(points), "{points:?}");
    phases
}

fn ghost_edges(mesh: &GhostMesh, v: u32) -> usize {
    (0..3 * mesh.slots() as u32).filter(|&h| mesh.origin(h) == v && mesh.destination(h) == GHOST).count()
}

fn circle(n: u32) -> Vec<DVec2> {
    let angle = |i: u32| std::f64::consts::TAU * f64::from(polder_flip::priority(i)) / 2f64.powi(32);
    (0..n).map(|i| DVec2::from_angle(angle(i))).collect()
}

#[test]
fn a_neck_is_not_a_vertex() {
    // A thin circle: long regions that pinch each other where they meet in the middle.
    let phases = right(&circle(300), Resolution::LongerSide(100));
    assert!(phases.dualized.necks > 10, "{} necks", phases.dualized.necks);
}

#[test]
fn a_region_that_meets_the_border_several_times_has_several_ghost_edges() {
    let points = [DVec2::new(0.0, 0.0), DVec2::new(50.0, 1.0), DVec2::new(100.0, 0.0), DVec2::new(50.0, 9.0)];
    let phases = right(&points, Resolution::LongerSide(100));
    let open = &phases.dualized.mesh;
    let twice = (0..4).filter(|&v| ghost_edges(open, v) == 2).count();
    assert_eq!(twice, 0, "{open}");

    // In a low strip every region but those at the ends meets the lower border and the upper one.
    let points: Vec<DVec2> = (0..8).map(|i| DVec2::new(f64::from(10 * i), f64::from(i * i % 5))).collect();
    let phases = right(&points, Resolution::LongerSide(40));
    let open = &phases.dualized.mesh;
    let twice = (0..8).filter(|&v| ghost_edges(open, v) == 2).count();
    assert!(twice >= 4, "{open}");
}

#[test]
fn a_strip_one_pixel_high_goes_through() {
    let mut random = Random::new(5);
    for flat in [1e-3, 1e-12, 5e-324] {
        let lying: Vec<DVec2> = (0..200).map(|_| DVec2::new(random.unit(), flat * random.unit())).collect();
        let standing: Vec<DVec2> = lying.iter().map(|p| p.perp()).collect();
        for points in [&lying, &standing] {
            let phases = right(points, Resolution::LongerSide(100));
            let sites = phases.voronoi.sites.count;
            assert_eq!(phases.voronoi.mapping.size().iter().min(), Some(&1));
            assert_eq!((phases.dualized.mesh.finite().count(), phases.dualized.mesh.slots()), (0, 2 * sites - 2));
        }
    }
}

#[test]
fn sites_on_one_line_go_through_though_the_points_are_not_on_it() {
    let mut random = Random::new(6);
    let mut near_diagonal = || DVec2::splat(f64::from(random.below(50) as u32) + 0.25) + 0.5 * random.point();
    let mut points: Vec<DVec2> = (0..300).map(|_| near_diagonal()).collect();
    // The corners of the grid, so that each of its 50 pixels a side is a unit square.
    points.extend([DVec2::ZERO, DVec2::splat(50.0)]);
    let phases = right(&points, Resolution::LongerSide(50));
    assert_eq!(phases.dualized.mesh.finite().count(), 0);
    assert!(phases.shifted.mesh.finite().count() > 50);
    assert!(!phases.inserted.bootstrapped);

    // Nor are all of the sites' true positions, but those of the sites that matter: all sites on the line y = 0, and a
    // single missing point off it.
    let mut points: Vec<DVec2> = (0..50).map(|i| DVec2::new(f64::from(i), 0.0)).collect();
    points.push(DVec2::new(20.0, 1e-5));
    let phases = right(&points, Resolution::LongerSide(50));
    assert_eq!(phases.shifted.mesh.finite().count(), 0);
    assert!(phases.inserted.bootstrapped);
    assert_eq!(phases.inserted.mesh.finite().count(), 49);
}

#[test]
fn a_site_on_no_vertex_inside_the_grid_is_closed_in() {
    let points = [DVec2::new(0.5, 0.5), DVec2::new(3.5, 3.5), DVec2::new(9.5, 2.5), DVec2::new(2.5, 9.5)];
    let phases = right(&points, Resolution::LongerSide(9));
    let corner = phases.voronoi.sites.order.iter().position(|&i| i == 0).unwrap() as u32;
    let closed = reference::dualize(&phases.voronoi.diagram, &phases.voronoi.sites).unwrap();
    let seen = |mesh: &GhostMesh| mesh.finite().any(|t| mesh.triangles[t].contains(&corner));
    assert!(!seen(&phases.dualized.mesh), "{}", phases.dualized);
    assert!(seen(&closed.mesh));
}

#[test]
fn the_hull_is_closed_again_where_moving_sites_has_made_it_reflex() {
    let phases = right(&circle(200), Resolution::PixelsPerPoint(7.0));
    assert!(phases.shifted.hull.flips > 0);
}

/// The stages once more, the hull closed before the sites move: that asks for more, and pins more of them.
fn closed_before(phases: Phases, points: &[DVec2]) -> Phases {
    let (voronoi, centers, positions) = (&phases.voronoi, phases.centers(), phases.positions(points));
    let dualized = reference::dualize(&voronoi.diagram, &voronoi.sites).unwrap();
    let shifted = reference::shift(dualized.mesh.clone(), &centers, &positions).unwrap();
    let new = reference::points_to_insert(&voronoi.diagram, &voronoi.sites, &shifted);
    let inserted = reference::insert(shifted.mesh.clone(), &positions, &new).unwrap();
    let closed = Phases { dualized, shifted, inserted, ..phases };
    assert_eq!(finish(points, &closed), by_sweep(points), "{points:?}");
    closed
}

/// On flat arcs with a closed hull so many sites are pinned that, in some, fewer than three are left that are not on one
/// line.
#[test]
fn an_arc_most_of_whose_sites_are_taken_out_goes_through() {
    let mut random = Random::new(8);
    let (mut chains, mut empty) = (0, 0);
    for _ in 0..1000 {
        let n = 3 + random.below(8);
        let bend = random.unit() * 0.2;
        let tilt = random.unit() - 0.5;
        let arc = |_| {
            let x = random.unit();
            DVec2::new(x, bend * x * (x - 1.0) + tilt * x)
        };
        let points: Vec<DVec2> = (0..n).map(arc).collect();
        let phases = closed_before(right(&points, Resolution::LongerSide(4 + random.below(12) as u32)), &points);
        if phases.dualized.mesh.finite().count() > 0 && phases.shifted.mesh.finite().count() == 0 {
            chains += usize::from(phases.shifted.mesh.slots() > 0);
            empty += usize::from(phases.shifted.mesh.slots() == 0);
        }
    }
    assert!(chains > 50 && empty > 0, "{chains} chains, {empty} empty");
}

/// A site that is taken out may find, when it returns, that a missing point equal to it has become the vertex. Which one
/// it was must not show: the lowest index stands for all.
#[test]
fn a_site_returns_after_its_twin() {
    let mut random = Random::new(9);
    let mut found = 0;
    for _ in 0..300 {
        let mut points = lattice_points(&mut random, 30, 9, 9);
        points.iter_mut().for_each(|p| *p = DVec2::new(p.x + 0.3 * p.y, p.y - 0.2 * p.x));
        points.extend(points.clone());
        let phases = right(&points, Resolution::PixelsPerPoint(7.0));
        found +=
            phases.shifted.taken_out().filter(|&(site, _)| phases.inserted.vertex_of[site as usize] != site).count();
        let order = &phases.voronoi.sites.order;
        let names = phases.inserted.names(order);
        let representatives = phases.inserted.representatives(order, &names);
        for (i, &r) in representatives.iter().enumerate() {
            assert_eq!(points.iter().position(|p| *p == points[i]), Some(r as usize));
        }
    }
    assert!(found > 20, "{found}");
}

#[test]
fn lattices_do_not_get_stuck() {
    let mut taken_out = 0;
    for side in [5, 9, 17, 33] {
        let lattice = (0..side * side).map(|i| DVec2::new(f64::from(i % side), f64::from(i / side)));
        for points in [
            lattice.clone().collect::<Vec<_>>(),
            lattice.clone().map(|p| DVec2::new(3.0 * p.x + 4.0 * p.y, 4.0 * p.x - 3.0 * p.y)).collect(),
            lattice.map(|p| DVec2::new(p.x + p.y, p.x - p.y)).collect(),
        ] {
            for resolution in [1.1, 1.7, 2.9, 7.0].map(Resolution::PixelsPerPoint) {
                taken_out += right(&points, resolution).shifted.taken_out().count();
            }
        }
    }
    assert!(taken_out > 500, "{taken_out}");
}

#[test]
fn crowds_in_one_pixel_go_through() {
    let mut random = Random::new(10);
    let crowd: Vec<DVec2> = (0..3000).map(|_| 1e-9 * random.point()).collect();
    let far = [DVec2::new(1.0, 0.7), DVec2::new(-1.0, 0.6), DVec2::new(0.1, -1.0)];
    for around in [&far[..], &far[..2], &far[..1], &[]] {
        let points = [&crowd, around].concat();
        let phases = phases(&points);
        let (rounds, flips) = (phases.inserted.rounds, phases.inserted.flips.flips);
        assert!(
            rounds <= 20 && flips <= 3 * points.len() as u64,
            "{} around: {rounds} rounds, {flips} flips",
            around.len()
        );
    }
    right(&[&crowd[..500], &far].concat(), Resolution::PixelsPerPoint(7.0));
    // A crowd of points all equal is one vertex.
    let points = [&vec![DVec2::splat(0.25); 3000], &far[..]].concat();
    let phases = right(&points, Resolution::PixelsPerPoint(7.0));
    assert_eq!(phases.inserted.duplicates, 2999);
}

/// Sorted by x, so that an order by index would insert each cluster from its left end on.
#[test]
fn sorted_clusters_need_few_rounds() {
    let mut random = Random::new(11);
    let mut points: Vec<DVec2> = (0..10)
        .flat_map(|_| {
            let center = random.point();
            (0..1000).map(|_| center + 1e-5 * (random.point() + random.point() - DVec2::ONE)).collect::<Vec<_>>()
        })
        .collect();
    points.sort_by(|p, q| p.x.total_cmp(&q.x));
    let phases = phases(&points);
    assert!(phases.inserted.rounds <= 18, "{} rounds", phases.inserted.rounds);
    assert!(phases.inserted.flips.flips <= 3 * points.len() as u64);
}

/// All points outside the hull of the sites: of each crowd beyond a hull edge, one comes first, and it has to be one in
/// the middle.
#[test]
fn points_along_a_circle_need_few_rounds() {
    let phases = phases(&circle(20_000));
    assert!(phases.inserted.rounds <= 16, "{} rounds", phases.inserted.rounds);
}

#[test]
fn exponential_clusters_need_few_rounds() {
    let mut random = Random::new(12);
    let points: Vec<DVec2> = (0..20_000).map(|_| 2f64.powi(-(random.below(46) as i32)) * random.point()).collect();
    let phases = phases(&points);
    assert!(phases.inserted.rounds <= 30, "{} rounds", phases.inserted.rounds);
}

#[test]
fn one_point_and_two_points() {
    let one = right(&[DVec2::new(3.0, -1.0)], Resolution::PixelsPerPoint(7.0));
    assert_eq!((one.dualized.mesh.slots(), one.shifted.heirs, one.inserted.vertex_of), (0, vec![NONE], vec![0]));
    let two = right(&[DVec2::new(3.0, -1.0), DVec2::new(1.0, 1.0)], Resolution::PixelsPerPoint(7.0));
    assert_eq!(two.inserted.mesh.slots(), 2);
    let same = right(&[DVec2::ONE; 5], Resolution::PixelsPerPoint(7.0));
    assert_eq!((same.inserted.mesh.slots(), same.inserted.duplicates), (0, 4));
}

#[test]
fn no_point_is_an_error() {
    assert!(reference::triangulate(&[], &Options::default()).is_err());
}
