//! The lemmas of [CET] 3.1 and 3.2, and those of 3.3 that speak of regions, each a property test of its own name, and
//! each shown to fail on a diagram that is wrong in a way it must notice.

mod coloring;
mod lassos;
mod mutations;
mod regions;

use crate::cases::{FAMILIES, SHARP, sites};
use polder_voronoi::{Diagram, Key, Sites, UNCOLORED, reference};
use proptest::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A flooded grid, or one said to be.
#[derive(Clone)]
pub(crate) struct Case {
    pub sites: Sites,
    pub diagram: Diagram,
    /// The pixels' indices in the order in which they were colored.
    pub colored: Vec<u32>,
}

/// A lemma's check: what violates it, if anything does.
pub(crate) type Lemma = fn(&Case) -> Result<(), String>;

impl Case {
    /// By the stage itself; the order of coloring from plain flooding.
    pub(crate) fn new(sites: Sites) -> Self {
        let mut diagram = reference::color(&sites).unwrap();
        reference::debris(&mut diagram, &sites).unwrap();
        reference::recolor(&mut diagram, &sites).unwrap();
        let colored = reference::flooding::flood(&sites).unwrap().colored;
        Self { sites, diagram, colored }
    }

    /// By flooding in any order of pixel-site pairs.
    pub(crate) fn flooded_by<K: Ord>(sites: Sites, key: impl Fn([u16; 2], usize) -> K) -> Self {
        let [width, height] = sites.size;
        let colors = vec![UNCOLORED; (width * height) as usize];
        let mut diagram = Diagram { width, height, colors, debris: Vec::new() };
        let mut colored = Vec::new();
        let mut queue = BinaryHeap::new();
        for (site, &pixel) in sites.pixels[..sites.count].iter().enumerate() {
            queue.push(Reverse((key(pixel, site), site, pixel)));
        }
        while let Some(Reverse((_, site, pixel))) = queue.pop() {
            let index = diagram.index(pixel);
            if diagram.colors[index] != UNCOLORED {
                continue;
            }
            diagram.colors[index] = site as u32;
            colored.push(index as u32);
            queue.extend(crate::cases::neighbors(sites.size, pixel).map(|p| Reverse((key(p, site), site, p))));
        }
        Self { sites, diagram, colored }
    }

    pub(crate) fn site(&self, color: u32) -> [u16; 2] {
        self.sites.pixels[color as usize]
    }

    /// The key of a pixel with the site of its color.
    pub(crate) fn key(&self, pixel: [u16; 2]) -> Key {
        Key::of(pixel, self.site(self.diagram.color(pixel)))
    }

    /// The neighbors of the same color that are closer to the site.
    pub(crate) fn predecessors(&self, pixel: [u16; 2]) -> Vec<[u16; 2]> {
        let color = self.diagram.color(pixel);
        let same = crate::cases::neighbors(self.sites.size, pixel).filter(|&p| self.diagram.color(p) == color);
        same.filter(|&p| self.key(p) < self.key(pixel)).collect()
    }
}

macro_rules! lemmas {
    ($($name:ident: $cases:literal cases, sides below $side:literal, $check:path;)*) => {
        $(
            proptest! {
                #![proptest_config(ProptestConfig::with_cases($cases))]
                #[test]
                fn $name(family in 0..FAMILIES.len(), side in 8_usize..$side, seed: u64) {
                    // Half of the cases are from families with sharp corners, where debris is.
                    let family = if seed % 2 == 0 { FAMILIES[family] } else { SHARP[family % SHARP.len()] };
                    let case = Case::new(sites(family, side, seed));
                    prop_assert_eq!($check(&case), Ok(()));
                }
            }
        )*
    };
}

lemmas! {
    ordered_coloring_lemma: 300 cases, sides below 40, coloring::ordered_coloring;
    monotonic_path_lemma: 500 cases, sides below 64, coloring::monotonic_path;
    one_neck_lemma: 500 cases, sides below 64, coloring::one_neck;
    bulk_lemma: 500 cases, sides below 64, regions::bulk;
    lasso_lemma: 120 cases, sides below 40, lassos::lasso;
    spliced_lasso_lemma: 80 cases, sides below 40, lassos::spliced_lasso;
    simple_connectedness_lemma: 300 cases, sides below 40, regions::simple_connectedness;
    deleting_a_seed_shrinks_regions_only_by_debris: 100 cases, sides below 40, regions::deleting_a_seed;
}
