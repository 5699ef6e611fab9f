//! Points alone: random, on lines, at the ends of f64.

use super::pslg;
use super::random::{Random, power_of_two};
use glam::DVec2;
use polder_mesh::Pslg;

/// Independent points, uniform in the unit square, on multiples of 2⁻⁵³.
pub fn uniform(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("uniform", seed);
    pslg((0..n).map(|_| random.square()).collect(), Vec::new())
}

/// Points about the origin, standard deviation 1 in each coordinate: sums of twelve uniform numbers, so that none lies
/// farther than 6 in x or y.
pub fn gaussian(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("gaussian", seed);
    pslg((0..n).map(|_| DVec2::new(random.normal(), random.normal())).collect(), Vec::new())
}

/// Points in `count` gaussian clusters of standard deviation `sigma`, their centers uniform in the unit square; each
/// point chooses its cluster at random. A `sigma` that is not finite counts as 0.
pub fn clusters(n: usize, count: usize, sigma: f64, seed: u64) -> Pslg {
    let mut random = Random::new("clusters", seed);
    let sigma = if sigma.is_finite() { sigma.clamp(-1e300, 1e300) } else { 0.0 };
    let centers: Vec<_> = (0..count.max(1)).map(|_| random.square()).collect();
    let point = |_| {
        let center = centers[random.below(centers.len() as u64) as usize];
        center + sigma * DVec2::new(random.normal(), random.normal())
    };
    pslg((0..n).map(point).collect(), Vec::new())
}

/// Points that crowd toward (1/2, 1/2): uniform in squares whose sides are 1, 1/2, 1/4, ... 2⁻⁴⁵.
pub fn exponential(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("exponential", seed);
    let point = |i: usize| DVec2::splat(0.5) + power_of_two(-((i % 46) as i32)) * (random.square() - 0.5);
    pslg((0..n).map(point).collect(), Vec::new())
}

/// All integer points of a rectangle, `width` by `height`, row by row from (0, 0).
pub fn lattice(width: usize, height: usize) -> Pslg {
    let point = |i: usize| DVec2::new((i % width) as f64, (i / width) as f64);
    pslg((0..width.saturating_mul(height)).map(point).collect(), Vec::new())
}

/// Integer points drawn with replacement from a square of about `n` of them: a third are duplicates, and four on a
/// circle or three on a line are the rule. Zeros carry either sign.
pub fn crowd(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("crowd", seed);
    let side = n.isqrt() as u64 | 1;
    let mut coordinate = || {
        let i = random.below(side) as f64 - (side / 2) as f64;
        if i == 0.0 && random.bits() & 1 == 1 { -0.0 } else { i }
    };
    pslg((0..n).map(|_| DVec2::new(coordinate(), coordinate())).collect(), Vec::new())
}

/// Distinct points exactly on one line, in random order: multiples of (3, 7).
pub fn collinear(n: usize, seed: u64) -> Pslg {
    let mut points: Vec<_> = (0..n).map(|i| DVec2::new(3.0 * i as f64, 7.0 * i as f64)).collect();
    Random::new("collinear", seed).shuffle(&mut points);
    pslg(points, Vec::new())
}

/// Points (x, y) with x uniform in [1/2, 1) and y at most `ulps` units in the last place from x.
pub fn near_collinear(n: usize, ulps: u32, seed: u64) -> Pslg {
    let mut random = Random::new("near-collinear", seed);
    let point = |_| {
        let x = 0.5 + 0.5 * random.unit();
        let steps = random.below(2 * ulps as u64 + 1) as i64 - ulps as i64;
        DVec2::new(x, x + steps as f64 * power_of_two(-53))
    };
    pslg((0..n).map(point).collect(), Vec::new())
}

/// Points along the line y = x / 3, off it by at most `noise`. A `noise` that is not finite counts as 0.
pub fn noisy_line(n: usize, noise: f64, seed: u64) -> Pslg {
    let mut random = Random::new("noisy-line", seed);
    let noise = if noise.is_finite() { noise.clamp(-1e300, 1e300) } else { 0.0 };
    let point = |_| {
        let x = random.unit();
        DVec2::new(x, x / 3.0 + noise * (2.0 * random.unit() - 1.0))
    };
    pslg((0..n).map(point).collect(), Vec::new())
}

/// Uniform in a square of side 2e300 about the origin.
pub fn huge(n: usize, seed: u64) -> Pslg {
    scaled("huge", n, 1e300, seed)
}

/// Uniform in a square of side 2e-300 about the origin.
pub fn tiny(n: usize, seed: u64) -> Pslg {
    scaled("tiny", n, 1e-300, seed)
}

fn scaled(family: &str, n: usize, scale: f64, seed: u64) -> Pslg {
    let mut random = Random::new(family, seed);
    pslg((0..n).map(|_| scale * (2.0 * random.square() - DVec2::ONE)).collect(), Vec::new())
}

/// Multiples of the smallest number above zero, 2⁻¹⁰⁷⁴, up to 4095 of them.
pub fn subnormal(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("subnormal", seed);
    let mut coordinate = || f64::from_bits(random.below(4096));
    pslg((0..n).map(|_| DVec2::new(coordinate(), coordinate())).collect(), Vec::new())
}

/// Coordinates of either sign and any magnitude from 2⁻¹⁰⁰⁰ to 2¹⁰⁰⁰, exponents uniform.
pub fn mixed_magnitudes(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("mixed-magnitudes", seed);
    let mut coordinate = || {
        let sign = if random.bits() & 1 == 1 { -1.0 } else { 1.0 };
        sign * power_of_two(random.below(2000) as i32 - 1000) * (1.0 + random.unit())
    };
    pslg((0..n).map(|_| DVec2::new(coordinate(), coordinate())).collect(), Vec::new())
}
