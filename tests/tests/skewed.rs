//! Thin and skewed sets through all stages: few flips, and the digest of the CPU.
#![allow(clippy::unwrap_used, reason = "tests")]

use glam::DVec2;
use polder::{Backend, Options, Pslg, triangulate};
use polder_io::generate;

/// Some rows of points one apart; so much between the rows.
fn rows(points: usize, rows: usize, distance: f64) -> Vec<DVec2> {
    let lattice = generate::lattice(points / rows, rows);
    lattice.points().iter().map(|p| DVec2::new(p.x, distance * p.y)).collect()
}

/// A square, pressed flat.
fn flat(points: usize, height: f64) -> Vec<DVec2> {
    generate::uniform(points, 3).points().iter().map(|p| DVec2::new(p.x, height * p.y)).collect()
}

fn assert_few_flips(name: &str, points: Vec<DVec2>) {
    assert_flips(name, points, [6, 200]);
}

/// So many flips a point at most, and so many rounds of all stages together.
fn assert_flips(name: &str, points: Vec<DVec2>, [most_flips, most_rounds]: [u64; 2]) {
    let pslg = Pslg::new(points, Vec::new()).unwrap();
    let run = |backend| triangulate(&pslg, &Options::with_backend(backend)).unwrap();
    let (stages, expected) = (run(Backend::Reference), run(Backend::Cpu));
    assert_eq!(stages.triangulation.digest(), expected.triangulation.digest(), "{name}");
    let count = |what| stages.report.stages.iter().filter_map(|stage| stage.counts.get(what)).sum::<u64>();
    let (flips, rounds) = (count("flips"), count("rounds"));
    assert!(flips <= most_flips * pslg.points().len() as u64, "{name}: {flips} flips");
    assert!(rounds <= most_rounds, "{name}: {rounds} rounds");
}

#[test]
fn rows_of_points_take_few_flips_however_close_they_are() {
    for distance in [1.0, 1e-2, 1e-9, 1e-30] {
        for count in [2, 3, 20] {
            assert_few_flips(&format!("{count} rows, {distance} apart"), rows(20_000, count, distance));
        }
        let columns = rows(20_000, 2, distance).iter().map(|p| p.perp()).collect();
        assert_few_flips(&format!("2 columns, {distance} apart"), columns);
    }
    // More columns than a grid has.
    for count in [2, 3] {
        assert_few_flips(&format!("{count} long rows"), rows(150_000, count, 1.0));
    }
}

#[test]
fn flat_sets_take_few_flips_however_flat_they_are() {
    for height in [1e-2, 1e-3, 1e-5, 1e-9, 1e-30, 1e-300] {
        assert_few_flips(&format!("flat, {height}"), flat(20_000, height));
    }
}

/// Flips are quadratic here if the mesh falls behind between rounds of insertion.
#[test]
fn crowded_and_curved_sets_take_few_flips() {
    for (name, pslg, most) in [
        ("concentric circles", generate::concentric(60_000, 4, 1), [8, 700]),
        ("points beside a line", generate::near_collinear(60_000, 1, 1), [3, 250]),
        ("mixed magnitudes", generate::mixed_magnitudes(30_000, 1), [8, 1500]),
        ("cocircular", generate::cocircular(60_000, 1), [8, 8000]),
        // Those that do not fall behind.
        ("clusters", generate::clusters(60_000, 10, 1e-4, 1), [4, 150]),
        ("thin ring", generate::thin_ring(60_000, 1e-9, 1), [4, 200]),
        ("circle", generate::circle(60_000, 1), [4, 200]),
    ] {
        assert_flips(name, pslg.points().to_vec(), most);
    }
}
