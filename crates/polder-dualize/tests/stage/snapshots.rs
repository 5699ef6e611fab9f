//! The text form of what each stage gives, on inputs small enough to be checked by eye.

use crate::common::phases_with;
use polder_dualize::DVec2;
use polder_voronoi::{Options, Resolution};

/// The diagram, then the three stages; vertices are numbered as sites, A is 0.
fn all(points: &[[f64; 2]], side: u32) -> String {
    let points: Vec<DVec2> = points.iter().map(|&p| DVec2::from_array(p)).collect();
    let phases = phases_with(&points, &Options::from(Resolution::LongerSide(side)));
    let diagram = phases.voronoi.diagram.letters(&phases.voronoi.sites);
    let (order, count) = (&phases.voronoi.sites.order, phases.voronoi.sites.count);
    format!(
        "{diagram}sites {:?}, missing {:?}\n\ndualized: {}\nshifted: {}\ninserted: {}",
        &order[..count],
        &order[count..],
        phases.dualized,
        phases.shifted,
        phases.inserted
    )
}

#[test]
fn scattered() {
    let points = [[0.0, 0.4], [8.0, 1.0], [3.6, 2.9], [6.0, 6.0], [1.0, 7.0], [3.9, 2.2], [9.0, 9.0], [8.0, 1.0]];
    insta::assert_snapshot!(all(&points, 10));
}

#[test]
fn strip() {
    insta::assert_snapshot!(all(&[[0.0, 0.0], [3.0, 0.2], [5.0, 0.0], [5.5, 0.3], [9.0, 0.1]], 10));
}

#[test]
fn arc() {
    let points: Vec<[f64; 2]> = (0..7).map(|i| f64::from(i) / 6.0).map(|x| [x, 0.3 * x * (1.0 - x)]).collect();
    insta::assert_snapshot!(all(&points, 12));
}

/// With sites that are taken out, one after the other since they are neighbors.
#[test]
fn bent() {
    let points: Vec<[f64; 2]> = (0..6).map(|i| DVec2::from_angle(0.35 * f64::from(i)).to_array()).collect();
    insta::assert_snapshot!(all(&points, 7));
}

/// With missing points inside and outside of the sites' hull.
#[test]
fn ring() {
    let on_ring = |i: u32| DVec2::from_angle(f64::from(i) * 0.7).to_array();
    let points: Vec<[f64; 2]> = (0..14).map(on_ring).chain([[0.1, 0.2], [0.15, 0.3]]).collect();
    insta::assert_snapshot!(all(&points, 7));
}

#[test]
fn line() {
    insta::assert_snapshot!(all(&[[0.0, 0.0], [1.0, 2.0], [2.0, 4.0], [1.0, 2.0]], 3));
}

#[test]
fn one_point() {
    insta::assert_snapshot!(all(&[[1.0, 2.0]], 3));
}
