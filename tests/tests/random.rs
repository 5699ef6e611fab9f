//! Inputs of any kind by the stages' references against the CPU backend, which shares none of their ways.
#![allow(clippy::unwrap_used, reason = "tests")]

mod random_support;

use polder::{Backend, CrossingPolicy, Error, Options, Output, Pslg, triangulate};

fn by_reference(pslg: &Pslg, crossings: CrossingPolicy) -> Result<Output, Error> {
    triangulate(pslg, &Options { crossings, ..Options::with_backend(Backend::Reference) })
}

#[test]
fn random_inputs_give_one_result() {
    for seed in 0..300 {
        random_support::case(seed, 300, by_reference);
    }
    for seed in random_support::FLIPPED_TO_CROSSINGS {
        random_support::case(seed, 3000, by_reference);
    }
}

#[test]
#[ignore = "long"]
fn many_random_inputs_give_one_result() {
    random_support::many(|seed, most| random_support::case(seed, most, by_reference));
}
