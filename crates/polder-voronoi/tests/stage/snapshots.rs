//! What each step gives on small inputs, in the readable forms.

use glam::DVec2;
use insta::assert_snapshot;
use polder_voronoi::{Diagram, Options, Resolution, Sites, reference};

/// The diagram after coloring, after debris lost its color, and after recoloring.
fn steps(sites: &Sites) -> [Diagram; 3] {
    let colored = reference::color(sites).unwrap();
    let mut without_debris = colored.clone();
    reference::debris(&mut without_debris, sites).unwrap();
    let mut recolored = without_debris.clone();
    reference::recolor(&mut recolored, sites).unwrap();
    [colored, without_debris, recolored]
}

#[test]
fn a_dozen_points() {
    let points = [
        (0.0, 0.0),
        (9.0, 0.5),
        (18.5, 0.0),
        (4.0, 4.5),
        (13.0, 3.5),
        (0.5, 8.0),
        (9.5, 8.5),
        (18.0, 7.0),
        (4.5, 12.0),
        (13.5, 11.5),
        (18.5, 12.0),
        (13.4, 11.4),
    ]
    .map(|(x, y)| DVec2::new(x, y));
    let output = reference::diagram(&points, &Resolution::LongerSide(28).into()).unwrap();
    assert_snapshot!("dozen_mapping", output.mapping);
    assert_snapshot!("dozen_sites", output.sites);
    assert_snapshot!("dozen_diagram", output.diagram.letters(&output.sites));
    assert_snapshot!("dozen_counts", output.counts);
}

/// Three sites on the smallest grid found that has debris at all: the corner of B's region is so sharp that one pixel
/// of it is cut off.
#[test]
fn a_sharp_corner() {
    let sites = reference::elect([14, 14], &[[0, 7], [6, 12], [12, 13]]).unwrap();
    let [colored, without_debris, recolored] = steps(&sites);
    assert_snapshot!("sharp_corner_colored", colored.letters(&sites));
    assert_snapshot!("sharp_corner_without_debris", without_debris.letters(&sites));
    assert_snapshot!("sharp_corner_recolored", recolored.letters(&sites));
}

/// Sites on half a circle: wedges that all narrow toward its center, with debris there. More than 62 sites: two letters.
#[test]
fn a_circle() {
    let points: Vec<DVec2> = (0..90)
        .map(|i| {
            // Rational points, so that no library's sine decides the picture.
            let t = f64::from(i) / 45.0 - 1.0;
            DVec2::new(2.0 * t, 1.0 - t * t) / (1.0 + t * t)
        })
        .collect();
    let output = reference::diagram(&points, &Resolution::LongerSide(48).into()).unwrap();
    let [colored, without_debris, recolored] = steps(&output.sites);
    assert_eq!(recolored, output.diagram);
    assert_snapshot!("circle_sites", output.sites);
    assert_snapshot!("circle_colored", colored.letters(&output.sites));
    assert_snapshot!("circle_without_debris", without_debris.letters(&output.sites));
    assert_snapshot!("circle_recolored", recolored.letters(&output.sites));
    assert_snapshot!("circle_counts", output.counts);
}

/// Ties: the lower site wins over the higher, the left over the right.
#[test]
fn ties_on_a_lattice() {
    let pixels: Vec<[u16; 2]> = (0..4).flat_map(|y| (0..5).map(move |x| [4 * x, 4 * y])).collect();
    let sites = reference::elect([17, 13], &pixels).unwrap();
    assert_snapshot!("lattice_recolored", steps(&sites)[2].letters(&sites));
}

#[test]
fn a_strip() {
    let points = [0.0, 1.0, 2.5, 7.0, 7.01, 9.0].map(|x| DVec2::new(x, -1.0));
    let output = reference::diagram(&points, &Resolution::PixelsPerPoint(6.0).into()).unwrap();
    assert_snapshot!(
        "strip",
        format!("{}\n{}\n{}", output.mapping, output.sites, output.diagram.letters(&output.sites))
    );
}

#[test]
fn the_picture_in_the_readme() {
    let points = [(0.0, 0.0), (4.0, 1.0), (1.0, 3.0)].map(|(x, y)| DVec2::new(x, y));
    let output = reference::diagram(&points, &Options::default()).unwrap();
    let picture = format!("```text\n{}```", output.diagram.letters(&output.sites));
    assert!(include_str!("../../README.md").contains(&picture), "the picture should be\n{picture}");
}
