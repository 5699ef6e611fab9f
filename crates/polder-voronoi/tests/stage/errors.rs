//! Bad input: an error that names what is at fault, never a panic.

use glam::DVec2;
use polder_voronoi::{Diagram, GridMapping, MAX_SIDE, Options, Resolution, Sites, UNCOLORED, VoronoiError, reference};

fn fit(points: &[DVec2], resolution: Resolution) -> Result<GridMapping, VoronoiError> {
    GridMapping::fit(points, &resolution.into())
}

#[test]
fn no_points() {
    assert_eq!(reference::diagram(&[], &Options::default()), Err(VoronoiError::NoPoints));
    let mapping = fit(&[DVec2::ZERO], Resolution::LongerSide(1)).unwrap();
    assert_eq!(reference::map(&[], &mapping), Err(VoronoiError::NoPoints));
    assert_eq!(reference::elect([3, 3], &[]), Err(VoronoiError::NoPoints));
    assert_eq!(reference::color(&Sites { size: [3, 3], ..Sites::default() }), Err(VoronoiError::NoPoints));
}

#[test]
fn a_coordinate_that_is_no_number() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let points = [DVec2::ZERO, DVec2::ONE, DVec2::new(0.5, bad), DVec2::splat(bad)];
        let error = VoronoiError::NonFiniteCoordinate { point: 2, axis: 'y' };
        assert_eq!(reference::diagram(&points, &Options::default()), Err(error));
        let error = VoronoiError::NonFiniteCoordinate { point: 0, axis: 'x' };
        assert_eq!(reference::diagram(&points[3..], &Options::default()), Err(error));
    }
}

#[test]
fn an_impossible_resolution() {
    let points = [DVec2::ZERO, DVec2::ONE];
    for side in [0, MAX_SIDE + 1, u32::MAX] {
        let error = VoronoiError::GridSide { side, limit: MAX_SIDE };
        assert_eq!(fit(&points, Resolution::LongerSide(side)), Err(error.clone()));
        assert_eq!(reference::elect([side, 1], &[[0, 0]]), Err(error));
    }
    for pixels in [0.0, -1.0, f64::NAN, f64::INFINITY, 1025.0] {
        assert_eq!(fit(&points, Resolution::PixelsPerPoint(pixels)), Err(VoronoiError::PixelsPerPoint));
    }
    assert_eq!(fit(&points, Resolution::LongerSide(MAX_SIDE)).unwrap().size(), [MAX_SIDE; 2]);
}

#[test]
fn a_pixel_outside_the_grid() {
    let outside = |index| VoronoiError::Mismatch { what: "a pixel outside the grid", index };
    assert_eq!(reference::elect([3, 2], &[[0, 0], [3, 0]]), Err(outside(1)));
    assert_eq!(reference::elect([3, 2], &[[2, 2]]), Err(outside(0)));
}

#[test]
fn sites_that_contradict_themselves() {
    let sound = reference::elect([5, 5], &[[1, 1], [1, 1], [4, 2], [3, 2], [1, 1]]).unwrap();
    assert_eq!(sound.check(), Ok(()));
    let spoilt: [fn(&mut Sites); 7] = [
        |s| s.count = 6,
        |s| s.count = 4,
        |s| s.pixels.swap(0, 1),
        |s| s.pixels[1] = s.pixels[0],
        |s| s.order.swap(3, 4),
        |s| s.pixels[2][1] = 5,
        |s| s.order.truncate(4),
    ];
    for (i, spoil) in spoilt.iter().enumerate() {
        let mut sites = sound.clone();
        spoil(&mut sites);
        assert!(matches!(reference::color(&sites), Err(VoronoiError::Mismatch { .. })), "{i}");
        assert!(matches!(reference::flooding::flood(&sites), Err(VoronoiError::Mismatch { .. })), "{i}");
    }
}

#[test]
fn a_diagram_that_contradicts_its_sites() {
    let sites = reference::elect([5, 4], &[[1, 1], [4, 2]]).unwrap();
    let sound = reference::color(&sites).unwrap();
    let spoilt: [fn(&mut Diagram); 8] = [
        |d| d.width = 4,
        |d| d.colors.truncate(19),
        |d| d.colors[3] = 2,
        |d| d.colors[3] = UNCOLORED,
        |d| d.colors[6] = 1,
        |d| d.debris = vec![3, 3],
        |d| d.debris = vec![20],
        |d| {
            d.debris = vec![2, 6];
            d.colors[6] = UNCOLORED;
        },
    ];
    for (i, spoil) in spoilt.iter().enumerate() {
        let mut diagram = sound.clone();
        spoil(&mut diagram);
        let is_mismatch = |result| matches!(result, Err(VoronoiError::Mismatch { .. }));
        assert!(is_mismatch(reference::debris(&mut diagram.clone(), &sites)), "{i}");
        assert!(is_mismatch(reference::recolor(&mut diagram.clone(), &sites)), "{i}");
        assert!(is_mismatch(reference::recolor_by_queue(&mut diagram.clone(), &sites)), "{i}");
        // Showing it is no fault.
        assert!(diagram.to_string().len() + diagram.letters(&sites).to_string().len() > 0);
    }
}

#[test]
fn debris_is_looked_for_in_colored_diagrams_only() {
    let sites = reference::elect([5, 4], &[[1, 1]]).unwrap();
    let mut diagram = reference::color(&sites).unwrap();
    (diagram.debris, diagram.colors[3]) = (vec![3], UNCOLORED);
    let error = VoronoiError::Mismatch { what: "a pixel without a color", index: 3 };
    assert_eq!(reference::debris(&mut diagram, &sites), Err(error));
}

/// Uncolored pixels beyond others that are nowhere near their site: no color reaches them, and the loops end.
#[test]
fn recoloring_that_gets_stuck_ends() {
    let sites = reference::elect([9, 1], &[[0, 0], [8, 0]]).unwrap();
    let mut diagram = reference::color(&sites).unwrap();
    diagram.colors.copy_from_slice(&[0, 0, 0, 1, UNCOLORED, 0, 1, 1, 1]);
    diagram.debris = vec![4];
    let stuck = Err(VoronoiError::Mismatch { what: "debris that no color reaches", index: 4 });
    assert_eq!(reference::recolor(&mut diagram.clone(), &sites), stuck);
    assert_eq!(reference::recolor_by_queue(&mut diagram, &sites), stuck);
}
