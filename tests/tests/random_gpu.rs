//! Inputs of any kind on a Vulkan device against the CPU backend.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod facade_gpu_support;
mod random_support;
mod vulkan_support;

use facade_gpu_support::{assert_on_device, close, open};
use polder::{CrossingPolicy, Gpu, Options};
use polder_flip::gpu::Arithmetic;

fn case(gpu: &mut Gpu, seed: u64, most: usize) {
    random_support::case(seed, most, |pslg, crossings| {
        let output = gpu.triangulate(pslg, &Options { crossings, ..Options::default() })?;
        if crossings == CrossingPolicy::Error {
            assert_on_device(&output.report, &format!("random({seed}, {most})"));
        }
        Ok(output)
    });
}

#[test]
fn random_inputs_have_the_digest_of_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    for seed in 0..24 {
        case(&mut gpu, seed, 300);
    }
    for seed in random_support::FLIPPED_TO_CROSSINGS {
        case(&mut gpu, seed, 3000);
    }
    close(gpu);
}

#[test]
#[ignore = "long"]
fn many_random_inputs_have_the_digest_of_the_cpu() {
    let mut gpu = open(Arithmetic::Filtered);
    random_support::many(|seed, most| case(&mut gpu, seed, most));
    close(gpu);
}
