//! The generators: the same bits everywhere, and what each promises.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_io::generate::*;
use polder_mesh::{DVec2, Pslg};
use std::collections::HashSet;
use std::fmt::Write;

fn all(n: usize, seed: u64) -> Vec<(&'static str, Pslg)> {
    vec![
        ("uniform", uniform(n, seed)),
        ("gaussian", gaussian(n, seed)),
        ("clusters", clusters(n, 5, 1e-4, seed)),
        ("exponential", exponential(n, seed)),
        ("circle", circle(n, seed)),
        ("concentric", concentric(n, 3, seed)),
        ("thin_ring", thin_ring(n, 1e-9, seed)),
        ("cocircular", cocircular(n, seed)),
        ("lattice", lattice(n / 10, 10)),
        ("crowd", crowd(n, seed)),
        ("collinear", collinear(n, seed)),
        ("near_collinear", near_collinear(n, 1, seed)),
        ("noisy_line", noisy_line(n, 1e-12, seed)),
        ("huge", huge(n, seed)),
        ("tiny", tiny(n, seed)),
        ("subnormal", subnormal(n, seed)),
        ("mixed_magnitudes", mixed_magnitudes(n, seed)),
        ("segments", segments(n, n / 4, seed)),
        ("crossing_segments", crossing_segments(n, n / 4, 0.5, seed)),
        ("spiral", spiral(n)),
        ("comb", comb(n)),
        ("fan", fan(n, seed)),
        ("through_vertices", through_vertices(n, seed)),
        ("nested_rings", nested_rings(n / 20, 1)),
    ]
}

/// A hash over the bits of everything.
fn fingerprint(pslg: &Pslg) -> u64 {
    let points = pslg.points().iter().flat_map(|p| [p.x.to_bits(), p.y.to_bits()]);
    let constraints = pslg.constraints().iter().flatten().map(|&v| v as u64);
    points
        .chain(constraints)
        .fold(0, |h: u64, w| ((h.rotate_left(23) ^ w).wrapping_mul(0x9e37_79b9_7f4a_7c15)).rotate_left(31))
}

#[test]
fn a_seed_means_the_same_bits_for_ever() {
    let mut table = String::new();
    for (name, pslg) in all(100, 1) {
        let (points, constraints) = (pslg.points().len(), pslg.constraints().len());
        writeln!(table, "{name} {points} {constraints} {:016x}", fingerprint(&pslg)).unwrap();
    }
    insta::assert_snapshot!(table);
}

#[test]
fn the_seed_matters_and_families_differ() {
    let seeds: HashSet<_> = (0..50).map(|seed| fingerprint(&uniform(10, seed))).collect();
    assert_eq!(seeds.len(), 50);
    let families: HashSet<_> = all(100, 7).iter().map(|(_, pslg)| fingerprint(pslg)).collect();
    assert_eq!(families.len(), all(100, 7).len());
}

#[test]
fn nothing_and_next_to_nothing_can_be_generated() {
    for n in 0..4 {
        for (name, pslg) in all(n, 3) {
            assert!(pslg.points().len() <= 2 * n + 2, "{name} makes {} points for {n}", pslg.points().len());
        }
    }
}

#[test]
fn cocircular_points_lie_on_one_circle_exactly() {
    let on = |pslg: &Pslg| -> HashSet<i128> {
        pslg.points().iter().map(|p| (p.x as i128).pow(2) + (p.y as i128).pow(2)).collect()
    };
    let distinct = |pslg: &Pslg| pslg.points().iter().map(|p| (p.x as i64, p.y as i64)).collect::<HashSet<_>>().len();
    let one = cocircular(2916, 5);
    assert_eq!(on(&one), HashSet::from([48_612_265i128.pow(2)]));
    assert_eq!(distinct(&one), 2916);
    let two = cocircular(3000, 5);
    assert_eq!((on(&two).len(), distinct(&two)), (2, 3000));
}

#[test]
fn gaussian_has_mean_zero_and_deviation_one() {
    let points = gaussian(100_000, 9).into_parts().0;
    let n = points.len() as f64;
    let mean = points.iter().sum::<DVec2>() / n;
    let square = points.iter().map(|p| p.length_squared()).sum::<f64>() / n;
    assert!(mean.length() < 0.02, "{mean}");
    assert!((square - 2.0).abs() < 0.03, "{square}");
}

fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i128 {
    let d = |p: [i64; 2], k: usize| (p[k] - a[k]) as i128;
    d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0)
}

fn on(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> bool {
    turn(a, b, p) == 0 && (0..2).all(|k| (a[k].min(b[k])..=a[k].max(b[k])).contains(&p[k]))
}

fn meet([a, b]: [[i64; 2]; 2], [c, d]: [[i64; 2]; 2]) -> bool {
    let apart = |a, b, c, d| turn(a, b, c).signum() * turn(a, b, d).signum();
    (apart(a, b, c, d) < 0 && apart(c, d, a, b) < 0) || on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b)
}

fn grid(pslg: &Pslg) -> (Vec<[i64; 2]>, Vec<[[i64; 2]; 2]>) {
    let scale = (1u64 << 30) as f64;
    let points: Vec<_> = pslg.points().iter().map(|p| [(p.x * scale) as i64, (p.y * scale) as i64]).collect();
    let segments = pslg.constraints().iter().map(|c| c.map(|v| points[v as usize])).collect();
    (points, segments)
}

#[test]
fn segments_touch_neither_each_other_nor_free_points() {
    for (n, m, seed) in [(200, 100, 1), (3000, 1000, 2), (5000, 300, 3)] {
        let pslg = segments(n, m, seed);
        assert_eq!((pslg.points().len(), pslg.constraints().len()), (n, m));
        let (points, segments) = grid(&pslg);
        for (i, &s) in segments.iter().enumerate() {
            assert!(segments[..i].iter().all(|&t| !meet(s, t)), "constraint {i} of ({n}, {m}, {seed})");
            assert!(points[2 * m..].iter().all(|&p| !on(s[0], s[1], p)));
        }
    }
}

#[test]
fn segments_are_long_and_short() {
    let pslg = segments(20_000, 10_000, 4);
    let mut lengths: Vec<_> =
        pslg.constraints().iter().map(|c| c.map(|v| pslg.points()[v as usize])).map(|[a, b]| a.distance(b)).collect();
    assert!(lengths.is_sorted_by(|a, b| *b < 1.4 * a), "from long to short, but for the failed tries");
    lengths.sort_unstable_by(f64::total_cmp);
    assert!(lengths[9_999] > 0.3 && lengths[5_000] < 0.02 && lengths[0] < 0.003, "{lengths:?}");
}

#[test]
fn crossing_segments_cross() {
    let (_, segments) = grid(&crossing_segments(200, 100, 0.5, 1));
    assert!((0..100).any(|i| (0..i).any(|j| meet(segments[i], segments[j]))));
    assert_eq!(crossing_segments(3, 9, 0.0, 1).constraints().len(), 9);
}

#[test]
fn through_vertices_runs_from_the_first_to_the_last_on_the_line() {
    let pslg = through_vertices(50, 8);
    let [a, b] = pslg.constraints()[0].map(|v| pslg.points()[v as usize]);
    let line = DVec2::new(3.0, 7.0) * 51.0;
    assert!((a, b) == (DVec2::ZERO, line) || (b, a) == (DVec2::ZERO, line), "{a} {b}");
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn a_million_constraints_take_seconds() {
    let start = std::time::Instant::now();
    let pslg = segments(10_000_000, 1_000_000, 1);
    let longest = pslg.constraints().iter().map(|c| c.map(|v| pslg.points()[v as usize])).map(|[a, b]| a.distance(b));
    println!("{:?}, longest {}", start.elapsed(), longest.fold(0.0, f64::max));
    assert_eq!(pslg.constraints().len(), 1_000_000);
}
