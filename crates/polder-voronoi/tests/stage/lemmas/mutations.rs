//! Each lemma's check finds a fault in diagrams that are wrong on purpose.

use super::regions::shrinks_by_debris_alone;
use super::{Case, Lemma, coloring, lassos, regions};
use crate::cases::{Family, Random, sites, without};
use polder_voronoi::{Key, reference};
use std::cmp::Reverse;

/// A way to be wrong, as a function of the case and a seed.
type Mutation = fn(&Case, u64) -> Case;

/// Debris keeps its Euclidean color.
fn debris_left_unrepaired(case: &Case, _: u64) -> Case {
    let diagram = reference::color(&case.sites).unwrap();
    let mut mutated = Case { diagram, ..case.clone() };
    mutated.colored.sort_by_key(|&index| {
        let pixel = case.diagram.pixel(index as usize);
        Key::of(pixel, case.site(mutated.diagram.colors[index as usize]))
    });
    mutated
}

/// Two pixels, neither a site's, change places in the order of coloring.
fn order_swapped(case: &Case, seed: u64) -> Case {
    let mut random = Random(seed);
    let mut mutated = case.clone();
    let (from, to) = (case.sites.count, case.colored.len());
    if to - from >= 2 {
        let mut pick = || from + random.below(to - from);
        let (a, b) = (pick(), pick());
        mutated.colored.swap(a, b);
    }
    mutated
}

/// Two pixels that share a side, neither a site's, exchange their colors.
fn colors_swapped(case: &Case, seed: u64) -> Case {
    let mut random = Random(seed);
    let mut mutated = case.clone();
    let width = case.sites.size[0] as usize;
    for _ in 0..10_000 {
        let a = random.below(case.diagram.colors.len());
        let b = if random.below(2) == 0 { a + 1 } else { a + width };
        if b >= case.diagram.colors.len() || b == a + 1 && b % width == 0 {
            continue;
        }
        let own = [a, b].map(|index| case.diagram.pixel(index) == case.site(case.diagram.colors[index]));
        if own == [false; 2] && case.diagram.colors[a] != case.diagram.colors[b] {
            mutated.diagram.colors.swap(a, b);
            break;
        }
    }
    mutated
}

/// Two pixels anywhere, neither a site's, exchange their colors.
fn far_colors_swapped(case: &Case, seed: u64) -> Case {
    let mut random = Random(seed);
    let mut mutated = case.clone();
    let colors = &mut mutated.diagram.colors;
    for _ in 0..10_000 {
        let (a, b) = (random.below(colors.len()), random.below(colors.len()));
        let own = [a, b].map(|index| case.diagram.pixel(index) == case.site(colors[index]));
        if own == [false; 2] && colors[a] != colors[b] {
            colors.swap(a, b);
            break;
        }
    }
    mutated
}

/// Flooding that settles ties by another order than the one it is held against.
fn ties_reversed(case: &Case, _: u64) -> Case {
    let sites = case.sites.clone();
    Case::flooded_by(case.sites.clone(), move |pixel, site| {
        let distance = Key::of(pixel, sites.pixels[site]).squared_distance();
        (distance, Reverse(site), Reverse(pixel))
    })
}

/// Flooding in an order that is no distance: one site's distances count a quarter.
fn order_of_no_distance(case: &Case, seed: u64) -> Case {
    let sites = case.sites.clone();
    let favored = Random(seed).below(sites.count);
    Case::flooded_by(case.sites.clone(), move |pixel, site| {
        let distance = Key::of(pixel, sites.pixels[site]).squared_distance();
        (if site == favored { distance / 16 } else { distance }, site, pixel)
    })
}

/// Runs a lemma on sound cases, which pass, and on their mutations, some of which must not.
fn assert_detects(lemma: Lemma, mutation: Mutation, family: Family) {
    let mut detected = 0;
    for seed in 0..30 {
        let case = Case::new(sites(family, 40, seed));
        assert_eq!(lemma(&case), Ok(()), "seed {seed}");
        detected += usize::from(lemma(&mutation(&case, seed)).is_err());
    }
    assert!(detected > 0, "no seed shows the fault");
}

#[test]
fn ordered_coloring_lemma_fails_on_unrepaired_debris() {
    assert_detects(coloring::ordered_coloring, debris_left_unrepaired, Family::Circle);
}

#[test]
fn ordered_coloring_lemma_fails_on_a_swapped_order() {
    assert_detects(coloring::ordered_coloring, order_swapped, Family::Random);
}

#[test]
fn ordered_coloring_lemma_fails_on_swapped_colors() {
    assert_detects(coloring::ordered_coloring, colors_swapped, Family::Random);
}

#[test]
fn ordered_coloring_lemma_fails_on_another_order_of_ties() {
    assert_detects(coloring::ordered_coloring, ties_reversed, Family::Cocircular);
}

#[test]
fn monotonic_path_lemma_fails_on_unrepaired_debris() {
    assert_detects(coloring::monotonic_path, debris_left_unrepaired, Family::Circle);
}

#[test]
fn monotonic_path_lemma_fails_on_swapped_colors() {
    assert_detects(coloring::monotonic_path, far_colors_swapped, Family::Random);
}

#[test]
fn one_neck_lemma_fails_on_swapped_colors() {
    assert_detects(coloring::one_neck, colors_swapped, Family::Random);
}

#[test]
fn bulk_lemma_fails_on_swapped_colors() {
    assert_detects(regions::bulk, colors_swapped, Family::Random);
}

#[test]
fn bulk_lemma_fails_on_another_order_of_ties() {
    assert_detects(regions::bulk, ties_reversed, Family::Cocircular);
}

#[test]
fn lasso_lemma_fails_on_an_order_of_no_distance() {
    assert_detects(lassos::lasso, order_of_no_distance, Family::Random);
}

#[test]
fn spliced_lasso_lemma_fails_on_an_order_of_no_distance() {
    assert_detects(lassos::spliced_lasso, order_of_no_distance, Family::Random);
}

#[test]
fn simple_connectedness_lemma_fails_on_unrepaired_debris() {
    assert_detects(regions::simple_connectedness, debris_left_unrepaired, Family::Circle);
}

#[test]
fn simple_connectedness_lemma_fails_on_swapped_colors() {
    assert_detects(regions::simple_connectedness, far_colors_swapped, Family::Random);
}

/// A hole alone, in a region that stays connected: one inner pixel takes a color that surrounds it nowhere.
#[test]
fn simple_connectedness_lemma_fails_on_another_order_of_distance() {
    assert_detects(regions::simple_connectedness, order_of_no_distance, Family::Sparse);
}

#[test]
fn deleting_a_seed_remark_fails_on_swapped_colors() {
    let mut detected = 0;
    for seed in 0..30 {
        let case = Case::new(sites(Family::Random, 30, seed));
        let after = Case::new(without(&case.sites, 0));
        shrinks_by_debris_alone(&case, &after, 0).unwrap();
        detected += usize::from(shrinks_by_debris_alone(&case, &colors_swapped(&after, seed), 0).is_err());
    }
    assert!(detected > 0, "no seed shows the fault");
}
