//! Thousands of small inputs with ties and duplicates, against another way to the same triangulation.

use crate::common::{Random, by_sweep, finish, lattice_points, phases_with};
use polder_dualize::DVec2;
use polder_voronoi::{Options, Resolution};

fn check(points: &[DVec2], resolution: Resolution) {
    let phases = phases_with(points, &Options::from(resolution));
    let ours = finish(points, &phases);
    let other = by_sweep(points);
    assert_eq!(ours, other, "{points:?} {resolution:?}");
}

/// Few points with many ties: of a small lattice, sheared, jittered or mirrored; on an arc; on a line but for one last
/// place; around one point in ever smaller distances.
fn points(random: &mut Random) -> Vec<DVec2> {
    let n = 1 + random.below(40) as usize;
    let (width, height) = (1 + random.below(12), 1 + random.below(12));
    let mut points = lattice_points(random, n, width, height);
    let (bend, slope) = (random.unit(), random.unit());
    match random.below(7) {
        0 => points.iter_mut().for_each(|p| *p = p.perp() - DVec2::new(0.5 * p.x, -7.0)),
        1 => points.iter_mut().for_each(|p| *p += 1e-3 * random.point()),
        2 => points.iter_mut().for_each(|p| *p = DVec2::new(p.x + p.y * 3.0, p.y + p.x * 3.0)),
        3 => points.iter_mut().for_each(|p| p.y = bend * p.x * p.x + slope * p.x),
        4 => points.iter_mut().for_each(|p| {
            p.y = slope * p.x;
            p.y = if random.below(2) == 0 { p.y.next_up() } else { p.y };
        }),
        5 => points.iter_mut().for_each(|p| *p *= 2f64.powi(-(random.below(46) as i32))),
        _ => {}
    }
    points
}

fn run(inputs: u64, seed: u64) {
    let mut random = Random::new(seed);
    for _ in 0..inputs {
        let points = points(&mut random);
        let resolution = match random.below(4) {
            0 => Resolution::LongerSide(1 + random.below(20) as u32),
            1 => Resolution::PixelsPerPoint(1.0),
            2 => Resolution::PixelsPerPoint(30.0),
            _ => Resolution::PixelsPerPoint(7.0),
        };
        check(&points, resolution);
    }
}

#[test]
fn small_inputs_end_at_the_canonical_triangulation() {
    run(4000, 1);
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn very_many_small_inputs_end_at_the_canonical_triangulation() {
    run(400_000, 2);
}
