//! Inputs of any kind by the CPU and by another way: points alone, all constraints, and those of them that do not cross.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use polder::{Backend, CrossingPolicy, Error, Options, Output, Pslg, triangulate};
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// Cutting more than that takes long.
const MOST_CUT: usize = 500;

/// The constraints left when of each pair that crosses the second one goes.
fn without_crossings(pslg: &Pslg, pairs: &[[u32; 2]]) -> Pslg {
    let gone: HashSet<u32> = pairs.iter().map(|pair| pair[1]).collect();
    let left = (0..).zip(pslg.constraints()).filter(|(i, _)| !gone.contains(i)).map(|(_, constraint)| *constraint);
    Pslg::new(pslg.points().to_vec(), left.collect()).unwrap()
}

/// The other way gives what the CPU gives, all of it, the error too.
pub(crate) fn case(seed: u64, most: usize, mut other: impl FnMut(&Pslg, CrossingPolicy) -> Result<Output, Error>) {
    let mut compare = |what: &str, pslg: &Pslg, crossings: CrossingPolicy| {
        let expected = triangulate(pslg, &Options { crossings, ..Options::with_backend(Backend::Cpu) });
        let name = format!("random({seed}, {most}), {what}");
        match (other(pslg, crossings), expected) {
            (Ok(found), Ok(expected)) => {
                polder_tests::assert_same_output(&name, &found, &expected);
                None
            }
            (found, expected) => {
                assert_eq!(found.as_ref().err(), expected.as_ref().err(), "{name}");
                expected.err()
            }
        }
    };
    let pslg = polder_tests::random(seed, most);
    let alone = Pslg::new(pslg.points().to_vec(), Vec::new()).unwrap();
    compare("points", &alone, CrossingPolicy::Error);
    if let Some(Error::CrossingConstraints { pairs, .. }) = compare("constraints", &pslg, CrossingPolicy::Error) {
        if pairs.len() < MOST_CUT {
            compare("constraints cut", &pslg, CrossingPolicy::Split);
        }
        compare("constraints left", &without_crossings(&pslg, &pairs), CrossingPolicy::Error);
    }
}

/// Of these, a pair of constraints crosses, and the one becomes an edge by flips of the other. Nothing may go unnoticed.
pub(crate) const FLIPPED_TO_CROSSINGS: [u64; 3] = [4_003_173, 5_002_478, 6_000_584];

/// For a minute, or `POLDER_SECONDS`, from `POLDER_SEED` on, with up to `POLDER_POINTS` points.
pub(crate) fn many(mut case: impl FnMut(u64, usize)) {
    let number = |name, otherwise| std::env::var(name).map_or(otherwise, |text| text.parse().unwrap());
    let end = Duration::from_secs(number("POLDER_SECONDS", 60));
    let (first, most) = (number("POLDER_SEED", 1000), number("POLDER_POINTS", 3000));
    let start = Instant::now();
    let mut seed = first;
    while start.elapsed() < end {
        case(seed, most as usize);
        seed += 1;
    }
    println!("{} inputs", seed - first);
}
