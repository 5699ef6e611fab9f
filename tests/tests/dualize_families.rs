//! Stages 1 to 4, and flips after them, on every family of inputs: the canonical triangulation, however the grid is
//! chosen, whatever the order of the points, and the same edges as spade's.
#![allow(clippy::unwrap_used, reason = "tests")]

use glam::DVec2;
use polder_dualize::reference::{self, Phases};
use polder_mesh::{Chains, Monitor, Parts, Pslg, Triangulation};
use polder_tests::{point_families, shuffled};
use polder_voronoi::{Options, Resolution};
use spade::{DelaunayTriangulation, Point2, Triangulation as _};

/// All stages; each ends with a certificate, and its links and counts are checked here.
fn stages(name: &str, points: &[DVec2], options: &Options) -> Phases {
    let phases = reference::triangulate(points, options).unwrap_or_else(|error| panic!("{name}: {error}"));
    for mesh in [&phases.dualized.mesh, &phases.shifted.mesh, &phases.inserted.mesh] {
        mesh.check().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    phases
}

/// Flips to the end, and back to the input's numbering.
fn finish(points: &[DVec2], phases: &Phases) -> Triangulation {
    let mut mesh = phases.inserted.mesh.clone();
    polder_flip::reference::flip(&mut mesh, &phases.positions(points)).unwrap();
    let order = &phases.voronoi.sites.order;
    let names = phases.inserted.names(order);
    let representatives = phases.inserted.representatives(order, &names);
    Triangulation::from_mesh(&mesh, &names, Parts { representatives, chains: Chains::default() })
}

fn by_cpu(points: &[DVec2]) -> Triangulation {
    polder_cpu::Delaunay::new(points, Monitor::default()).unwrap().finish(Chains::default())
}

fn check(name: &str, points: &[DVec2], options: &Options) -> Phases {
    let phases = stages(name, points, options);
    let ours = finish(points, &phases);
    assert!(ours == by_cpu(points), "{name}, {options:?}: not the canonical triangulation");
    phases
}

#[test]
fn every_family_ends_at_the_canonical_triangulation() {
    for (n, seed) in [(3, 1), (10, 2), (60, 3), (1500, 4)] {
        for (name, pslg) in point_families(n, seed) {
            check(name, pslg.points(), &Options::default());
        }
    }
}

#[test]
fn the_grid_does_not_show() {
    for (name, pslg) in point_families(300, 5) {
        for resolution in [Resolution::LongerSide(1), Resolution::LongerSide(17), Resolution::PixelsPerPoint(40.0)] {
            check(name, pslg.points(), &resolution.into());
        }
    }
}

#[test]
fn the_order_of_the_points_does_not_show() {
    for (name, pslg) in point_families(400, 6) {
        let expected = finish(pslg.points(), &stages(name, pslg.points(), &Options::default())).digest();
        for seed in 0..3 {
            let other = shuffled(&pslg, seed);
            let points = other.pslg.points();
            let ours = finish(points, &stages(name, points, &Options::default()));
            assert_eq!(other.digest_back(&ours), expected, "{name}, shuffled {seed}");
        }
    }
}

/// Edges of random points, which have no ties, as pairs of indices.
fn spade_edges(points: &[DVec2]) -> Vec<[u32; 2]> {
    let mut mesh = DelaunayTriangulation::<Point2<f64>>::new();
    let handles: Vec<_> = points.iter().map(|p| mesh.insert(Point2::new(p.x, p.y)).unwrap()).collect();
    let mut index = vec![u32::MAX; points.len()];
    for (i, handle) in handles.iter().enumerate() {
        index[handle.index()] = index[handle.index()].min(i as u32);
    }
    let ends = mesh.undirected_edges().map(|e| e.vertices().map(|v| index[v.fix().index()]));
    let mut edges: Vec<[u32; 2]> = ends.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges
}

#[test]
fn random_points_have_the_edges_of_spade() {
    let inputs: [(&str, Pslg); 3] = [
        ("uniform", polder_io::generate::uniform(20_000, 7)),
        ("gaussian", polder_io::generate::gaussian(20_000, 8)),
        ("clusters", polder_io::generate::clusters(20_000, 20, 1e-4, 9)),
    ];
    for (name, pslg) in inputs {
        let ours = finish(pslg.points(), &stages(name, pslg.points(), &Options::default()));
        let mut edges: Vec<[u32; 2]> =
            ours.edges().map(|e| e.vertices.map(|v| v.0)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        assert!(edges == spade_edges(pslg.points()), "{name}: the edges differ");
    }
}

/// Lines of counts, so that a change of what the stages do to some family is seen.
#[test]
fn counts() {
    let mut lines = String::new();
    for (name, pslg) in point_families(2000, 10) {
        let phases = stages(name, pslg.points(), &Options::default());
        let (d, s, i) = (&phases.dualized, &phases.shifted, &phases.inserted);
        let [pin, unpin, out] = s.rounds;
        lines += &format!(
            "{name}: {} sites, {} missing; {} necks; {} hull flips, {} pinned, {} taken out, rounds {pin} {unpin} {out}; \
             {} inserted, {} duplicates, {} rounds, {} flips{}\n",
            phases.voronoi.counts.sites,
            phases.voronoi.counts.missing,
            d.necks,
            s.hull.flips,
            s.bad,
            s.taken_out().count(),
            i.inserted,
            i.duplicates,
            i.rounds,
            i.flips.flips,
            if i.bootstrapped { ", bootstrapped" } else { "" },
        );
    }
    insta::assert_snapshot!(lines);
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn every_large_family_ends_at_the_canonical_triangulation() {
    for (name, pslg) in point_families(20_000, 11) {
        check(name, pslg.points(), &Options::default());
    }
    for seed in 0..200 {
        for (name, pslg) in point_families(40, seed) {
            check(name, pslg.points(), &Options::default());
        }
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn a_million_points_end_at_the_canonical_triangulation() {
    let inputs = [
        ("uniform", polder_io::generate::uniform(1_000_000, 12)),
        ("clusters", polder_io::generate::clusters(1_000_000, 100, 1e-4, 13)),
        ("lattice", polder_io::generate::lattice(1000, 1000)),
        ("circle", polder_io::generate::circle(100_000, 14)),
        ("exponential", polder_io::generate::exponential(300_000, 15)),
    ];
    for (name, pslg) in inputs {
        let phases = check(name, pslg.points(), &Options::default());
        assert!(phases.inserted.rounds < 80, "{name}: {} rounds", phases.inserted.rounds);
    }
}
