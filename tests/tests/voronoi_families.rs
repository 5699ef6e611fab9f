//! The digital Voronoi diagram of every family of inputs: held against flooding, and against the points themselves.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_tests::families;
use polder_voronoi::reference::{self, Output};
use polder_voronoi::{DVec2, Options, Resolution};

/// The finished diagram is that of flooding, and recoloring by the queue gives it too.
fn assert_is_flooding(name: &str, output: &Output) {
    let sites = &output.sites;
    let mut by_queue = reference::color(sites).unwrap();
    reference::debris(&mut by_queue, sites).unwrap();
    reference::recolor_by_queue(&mut by_queue, sites).unwrap();
    assert_eq!(by_queue, output.diagram, "{name}");
    let flooded = reference::flooding::flood(sites).unwrap().diagram;
    assert_eq!(flooded.colors, output.diagram.colors, "{name}");
}

/// Points in different columns or rows are ordered as these are, and as the centers of their pixels are.
fn assert_keeps_order(name: &str, points: &[DVec2], output: &Output) {
    let (mapping, sites) = (&output.mapping, &output.sites);
    for k in [0, 1] {
        let mut positions: Vec<(u16, f64)> = Vec::new();
        for (&point, &pixel) in sites.order.iter().zip(&sites.pixels) {
            let center = mapping.center(pixel.map(u32::from));
            assert_eq!(mapping.pixel(center), pixel.map(u32::from), "{name}");
            positions.extend([(pixel[k], points[point as usize][k]), (pixel[k], center[k])]);
        }
        positions.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let is_sound = |pair: &[(u16, f64)]| pair[0].0 == pair[1].0 || pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1;
        assert!(positions.windows(2).all(is_sound), "{name}");
    }
}

#[test]
fn every_family_is_flooded_as_defined() {
    for (name, pslg) in families(1500, 5) {
        for options in [Options::default(), Resolution::LongerSide(60).into()] {
            let output = reference::diagram(pslg.points(), &options).unwrap();
            assert_is_flooding(name, &output);
        }
    }
}

#[test]
fn every_family_keeps_its_order_on_the_grid() {
    for (name, pslg) in families(3000, 6) {
        for options in [Options::default(), Resolution::LongerSide(100).into()] {
            let output = reference::diagram(pslg.points(), &options).unwrap();
            assert_keeps_order(name, pslg.points(), &output);
        }
    }
}

#[test]
fn every_family_counts_every_point_once() {
    for (name, pslg) in families(3000, 7) {
        let output = reference::diagram(pslg.points(), &Options::default()).unwrap();
        let (counts, sites) = (output.counts, &output.sites);
        assert_eq!(counts.points, counts.sites + counts.missing, "{name}");
        assert_eq!(counts.debris, output.diagram.debris.len() as u64, "{name}");
        let mut order = sites.order.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..pslg.points().len() as u32), "{name}");
        // The whole stage again gives the same bits.
        assert_eq!(reference::diagram(pslg.points(), &Options::default()).unwrap(), output, "{name}");
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn a_hundred_thousand_points_are_flooded_as_defined() {
    for (name, pslg) in families(100_000, 8) {
        let output = reference::diagram(pslg.points(), &Options::default()).unwrap();
        assert_is_flooding(name, &output);
        println!("{name}: {}", output.counts);
    }
}
