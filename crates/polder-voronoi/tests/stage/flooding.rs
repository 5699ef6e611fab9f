//! Debris, and recoloring it three ways.

use crate::cases::{self, FAMILIES, Family, neighbors, pixels, sites};
use polder_voronoi::{Diagram, Key, Sites, UNCOLORED, reference};
use proptest::prelude::*;

/// By definition: the pixels that no path of their own color connects with their site. Ascending.
pub(crate) fn cut_off(diagram: &Diagram, sites: &Sites) -> Vec<u32> {
    let mut reached = vec![false; diagram.colors.len()];
    let mut stack: Vec<[u16; 2]> = sites.pixels[..sites.count].to_vec();
    stack.iter().for_each(|&pixel| reached[diagram.index(pixel)] = true);
    while let Some(pixel) = stack.pop() {
        for next in neighbors(sites.size, pixel) {
            if diagram.color(next) == diagram.color(pixel) && !reached[diagram.index(next)] {
                reached[diagram.index(next)] = true;
                stack.push(next);
            }
        }
    }
    (0..reached.len() as u32).filter(|&index| !reached[index as usize]).collect()
}

/// A third way to recolor: rounds in which an uncolored pixel takes its best candidate for good when that comes before
/// the best candidates of all its uncolored neighbors. Returns the number of rounds.
fn recolor_by_minima(diagram: &mut Diagram, sites: &Sites) -> usize {
    let best = |diagram: &Diagram, pixel: [u16; 2]| {
        let colored = neighbors(sites.size, pixel).filter(|&p| diagram.color(p) != UNCOLORED);
        let offers = colored.map(|p| (p, diagram.color(p), sites.pixels[diagram.color(p) as usize]));
        let closer = offers.filter(|&(p, _, site)| Key::of(p, site) < Key::of(pixel, site));
        closer.map(|(_, color, site)| (Key::of(pixel, site), color)).min().unwrap_or((Key::MAX, UNCOLORED))
    };
    for round in 0.. {
        let left: Vec<[u16; 2]> = diagram.debris.iter().map(|&index| diagram.pixel(index as usize)).collect();
        let left: Vec<[u16; 2]> = left.into_iter().filter(|&pixel| diagram.color(pixel) == UNCOLORED).collect();
        let is_minimum = |pixel: [u16; 2]| {
            let mut rivals = neighbors(sites.size, pixel).filter(|&p| diagram.color(p) == UNCOLORED);
            rivals.all(|rival| best(diagram, pixel).0 < best(diagram, rival).0)
        };
        let winners: Vec<[u16; 2]> = left.iter().copied().filter(|&pixel| is_minimum(pixel)).collect();
        if winners.is_empty() {
            assert!(left.is_empty());
            return round;
        }
        let colors: Vec<u32> = winners.iter().map(|&pixel| best(diagram, pixel).1).collect();
        for (&pixel, color) in winners.iter().zip(colors) {
            let index = diagram.index(pixel);
            diagram.colors[index] = color;
        }
    }
    unreachable!("the loop above ends by returning")
}

/// Checks every step on one grid. Returns how much debris there was.
fn assert_steps_agree(sites: &Sites) -> usize {
    let euclidean = reference::color(sites).unwrap();
    let mut broken = euclidean.clone();
    reference::debris(&mut broken, sites).unwrap();
    assert_eq!(broken.debris, cut_off(&euclidean, sites), "debris is what is cut off");
    for (index, (&before, &after)) in euclidean.colors.iter().zip(&broken.colors).enumerate() {
        let is_debris = broken.debris.binary_search(&(index as u32)).is_ok();
        assert_eq!(after, if is_debris { UNCOLORED } else { before });
    }
    let (mut by_rounds, mut by_queue) = (broken.clone(), broken.clone());
    let mut by_minima = broken.clone();
    let rounds = reference::recolor(&mut by_rounds, sites).unwrap();
    reference::recolor_by_queue(&mut by_queue, sites).unwrap();
    recolor_by_minima(&mut by_minima, sites);
    assert_eq!(by_rounds, by_queue);
    assert_eq!(by_rounds, by_minima);
    assert_eq!(by_rounds.colors, reference::flooding::flood(sites).unwrap().diagram.colors);
    assert_eq!(rounds == 0, broken.debris.is_empty());
    assert!(rounds <= broken.debris.len() as u64 + 1, "{rounds} rounds");
    assert!(cut_off(&by_rounds, sites).is_empty());
    by_rounds.check(sites).unwrap();
    broken.debris.len()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn recoloring_in_rounds_equals_the_queue_equals_flooding(family in 0..FAMILIES.len(), side in 8_usize..48, seed: u64) {
        assert_steps_agree(&sites(FAMILIES[family], side, seed));
    }

    #[test]
    fn recoloring_equals_flooding_on_circles(side in 30_usize..100, seed: u64) {
        assert_steps_agree(&sites(Family::Circle, side, seed));
    }
}

#[test]
fn a_circle_has_much_debris() {
    let debris: usize = (0..20).map(|seed| assert_steps_agree(&sites(Family::Circle, 120, seed))).sum();
    assert!(debris > 300, "only {debris} pixels of debris");
}

#[test]
fn near_diagonal_sites_have_some_debris() {
    let debris: usize = (0..40).map(|seed| assert_steps_agree(&sites(Family::NearDiagonal, 100, seed))).sum();
    assert!(debris > 5, "only {debris} pixels of debris");
}

#[test]
fn many_rounds_of_recoloring_are_needed_somewhere() {
    let rounds = |seed| {
        let sites = sites(Family::Circle, 250, seed);
        let mut diagram = reference::color(&sites).unwrap();
        let found = reference::debris(&mut diagram, &sites).unwrap();
        (found, reference::recolor(&mut diagram, &sites).unwrap())
    };
    let (most_found, most_recolored) = (0..10).map(rounds).reduce(|a, b| (a.0.max(b.0), a.1.max(b.1))).unwrap();
    assert!(most_found >= 4 && most_recolored >= 4, "{most_found} and {most_recolored} rounds");
}

#[test]
fn steps_agree_without_any_debris() {
    for family in [Family::Pixel, Family::Strip, Family::Column, Family::Single, Family::Dense] {
        assert_eq!(assert_steps_agree(&sites(family, 30, 1)), 0);
    }
}

#[test]
fn recoloring_twice_changes_nothing() {
    let sites = sites(Family::Circle, 80, 4);
    let mut diagram = reference::color(&sites).unwrap();
    reference::debris(&mut diagram, &sites).unwrap();
    reference::recolor(&mut diagram, &sites).unwrap();
    let once = diagram.clone();
    assert!(!once.debris.is_empty());
    assert_eq!(reference::recolor(&mut diagram, &sites).unwrap(), 1);
    assert_eq!(diagram, once);
}

/// The comparison with flooding would notice debris that kept its color.
#[test]
fn debris_left_alone_is_noticed() {
    let sites = sites(Family::Circle, 80, 4);
    let euclidean = reference::color(&sites).unwrap();
    assert_ne!(euclidean.colors, reference::flooding::flood(&sites).unwrap().diagram.colors);
    assert!(!cut_off(&euclidean, &sites).is_empty());
}

#[test]
fn flooding_colors_every_pixel_once() {
    let sites = sites(Family::Random, 30, 9);
    let flooding = reference::flooding::flood(&sites).unwrap();
    let mut colored = flooding.colored;
    colored.sort_unstable();
    assert!(colored.iter().copied().eq(0..pixels(sites.size).count() as u32));
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn recoloring_equals_flooding_on_many_grids() {
    for seed in 0..20_000 {
        for family in cases::SHARP {
            assert_steps_agree(&sites(family, 8 + seed as usize % 60, seed));
        }
    }
}

/// Recoloring forgets wrong colors: it ends in the same diagram from whatever colors the debris has at first.
#[test]
fn recoloring_forgets_what_colors_debris_had() {
    for seed in 0..20 {
        let sites = sites(Family::Circle, 80, seed);
        let mut diagram = reference::color(&sites).unwrap();
        reference::debris(&mut diagram, &sites).unwrap();
        let mut random = cases::Random(seed);
        let mut spoilt = diagram.clone();
        for &index in &diagram.debris {
            spoilt.colors[index as usize] = random.below(sites.count) as u32;
        }
        reference::recolor(&mut diagram, &sites).unwrap();
        reference::recolor(&mut spoilt, &sites).unwrap();
        assert_eq!(spoilt, diagram);
    }
}
