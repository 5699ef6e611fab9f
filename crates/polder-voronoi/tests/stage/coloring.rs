//! The linear-time coloring against comparing every pixel with every site.

use crate::cases::{self, FAMILIES, Family, pixels, sites};
use polder_voronoi::{Key, Sites, reference};
use proptest::prelude::*;

/// Each pixel compared with each site.
pub(crate) fn brute_force(sites: &Sites) -> Vec<u32> {
    let nearest = |pixel| (0..sites.count).min_by_key(|&site| Key::of(pixel, sites.pixels[site])).unwrap() as u32;
    pixels(sites.size).map(nearest).collect()
}

fn assert_equals_brute_force(sites: &Sites) {
    assert_eq!(reference::color(sites).unwrap().colors, brute_force(sites));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn coloring_equals_brute_force(family in 0..FAMILIES.len(), side in 8_usize..48, seed: u64) {
        assert_equals_brute_force(&sites(FAMILIES[family], side, seed));
    }

    #[test]
    fn coloring_of_long_grids_equals_brute_force(side in 100_usize..600, seed: u64) {
        for family in [Family::Strip, Family::Column] {
            assert_equals_brute_force(&sites(family, side, seed));
        }
    }
}

/// All small grids with all sets of sites.
#[test]
fn coloring_of_all_small_grids_equals_brute_force() {
    for [width, height] in [[1, 8], [8, 1], [2, 4], [4, 2], [3, 3], [5, 2]] {
        let all: Vec<[u16; 2]> = pixels([width, height]).collect();
        for chosen in 1..1_u32 << all.len() {
            let sites: Vec<_> = (0..all.len()).filter(|i| chosen >> i & 1 == 1).map(|i| all[i]).collect();
            assert_equals_brute_force(&reference::elect([width, height], &sites).unwrap());
        }
    }
}

/// The longest sides there are, with sites at the far corners: squared distances near 2^31.
#[test]
fn coloring_reaches_across_the_longest_sides() {
    let last = 32767;
    for [width, height] in [[32768, 1], [1, 32768], [32768, 3], [3, 32768]] {
        let far = [(width - 1).min(last) as u16, (height - 1).min(last) as u16];
        let near_end = [far[0].saturating_sub(1), far[1].saturating_sub(1)];
        for corners in [vec![[0, 0]], vec![far], vec![[0, 0], far], vec![[0, 0], near_end, far]] {
            assert_equals_brute_force(&reference::elect([width, height], &corners).unwrap());
        }
    }
}

#[test]
fn coloring_of_a_large_square_from_its_corners() {
    let side = 4096_u16;
    let corners = [[0, 0], [side - 1, 0], [0, side - 1], [side - 1, side - 1]];
    let sites = reference::elect([u32::from(side); 2], &corners).unwrap();
    let diagram = reference::color(&sites).unwrap();
    let half = side / 2;
    let expected = |[x, y]: [u16; 2]| u32::from(x >= half) + 2 * u32::from(y >= half);
    assert!(pixels(sites.size).zip(&diagram.colors).all(|(pixel, &color)| color == expected(pixel)));
}

/// The comparison would notice a tie settled the other way.
#[test]
fn brute_force_differs_under_another_order_of_ties() {
    let sites = sites(Family::Lattice, 20, 3);
    let other = |pixel: [u16; 2]| {
        let key = |&site: &usize| (Key::of(pixel, sites.pixels[site]).squared_distance(), std::cmp::Reverse(site));
        (0..sites.count).min_by_key(key).unwrap() as u32
    };
    assert_ne!(brute_force(&sites), pixels(sites.size).map(other).collect::<Vec<_>>());
}

#[test]
fn sites_are_elected_by_lowest_index_and_numbered_by_pixel() {
    let pixels = [[3, 1], [0, 0], [3, 1], [2, 0], [0, 0], [3, 1], [1, 1]];
    let sites = reference::elect([4, 2], &pixels).unwrap();
    assert_eq!(sites.count, 4);
    assert_eq!(sites.order, [1, 3, 6, 0, 4, 2, 5]);
    let renumbered: Vec<[u16; 2]> = sites.order.iter().map(|&point| pixels[point as usize]).collect();
    assert_eq!(sites.pixels, renumbered);
    sites.check().unwrap();
}

proptest! {
    #[test]
    fn the_renumbering_is_a_permutation_in_pixel_order(family in 0..FAMILIES.len(), points in 1_usize..300, seed: u64) {
        let size = sites(FAMILIES[family], 24, seed).size;
        let mut random = cases::Random(seed);
        let pixels: Vec<[u16; 2]> =
            (0..points).map(|_| size.map(|side| random.below(side as usize) as u16)).collect();
        let sites = reference::elect(size, &pixels).unwrap();
        sites.check().unwrap();
        let mut order = sites.order.clone();
        order.sort_unstable();
        prop_assert!(order.iter().copied().eq(0..points as u32));
        for (&point, &pixel) in sites.order.iter().zip(&sites.pixels) {
            prop_assert_eq!(pixels[point as usize], pixel);
            let lowest = pixels.iter().position(|&p| p == pixel).unwrap();
            prop_assert_eq!(sites.order[..sites.count].contains(&point), lowest == point as usize);
        }
    }
}
