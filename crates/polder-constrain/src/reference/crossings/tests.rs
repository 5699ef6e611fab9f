#![allow(clippy::unwrap_used, reason = "tests")]

use super::*;
use crate::reference::walk;

fn random(seed: u32, i: usize, side: u32) -> u32 {
    polder_flip::priority(seed ^ (i as u32).wrapping_mul(0x9e37_79b9)) % side
}

/// Neither the size of the chunks nor the way through prefixes shows in the result, nor that pairs were tested instead.
#[test]
fn chunks_prefixes_and_tests_do_not_show() {
    for seed in 0..30 {
        let mut positions: Vec<DVec2> =
            (0..60).map(|i| DVec2::new(random(seed, 2 * i, 40).into(), random(seed, 2 * i + 1, 40).into())).collect();
        positions.sort_by(|a, b| polder_predicates::lexicographic(*a, *b));
        positions.dedup();
        let n = positions.len() as u32;
        let constraints: Vec<[u32; 2]> =
            (0..80).map(|i| [random(seed + 99, 2 * i, n), random(seed + 99, 2 * i + 1, n)]).collect();
        let (mesh, _) = polder_flip::reference::sweep(&positions).unwrap();
        let walk = walk(&mesh, &positions, &constraints).unwrap();
        let within = |max, chunk, tests| crossings_within(&mesh, &positions, &walk, max, chunk, tests).unwrap();
        let whole = crossings(&mesh, &positions, &walk, 1_000_000).unwrap();
        assert!(!whole.truncated && whole.pairs.len() > 300, "{}", whole.pairs.len());
        for chunk in [1, 7, 100] {
            assert_eq!(within(1_000_000, chunk, 0), whole);
        }
        let mut by_higher = whole.pairs.clone();
        by_higher.sort_unstable_by_key(|&[i, j]| (j, i));
        for max in [0, 1, 10, whole.pairs.len() - 1, whole.pairs.len()] {
            let mut pairs = by_higher[..max].to_vec();
            pairs.sort_unstable();
            let expected = Crossings { pairs, truncated: max < whole.pairs.len() };
            assert_eq!(crossings(&mesh, &positions, &walk, max).unwrap(), expected);
            // By prefixes; by tests of some pairs, if they suffice; of all pairs.
            for tests in [0, 1, 2, 4, 20, 64, 1000] {
                assert_eq!(within(max, 7, tests), expected);
            }
        }
    }
}
