//! Adaptive floating-point expansions, by the `robust` crate, inside the exponent range where they are proven exact.
//!
//! The predicates of Shewchuk (Shewchuk1997 in references.bib) are exact as long as nothing overflows or underflows.
//! Here is why neither happens when every coordinate that is not zero has an absolute value in `[2^-140, 2^200)`:
//!
//! - **Underflow.** Such coordinates are multiples of `2^-192`. So are their rounded differences and the tails of
//!   those, and whatever the predicates build is a sum of products of at most four of these, so a multiple of
//!   `2^-768`: never subnormal, so that no product of an expansion loses a bit. The error bounds of the early exits
//!   multiply such a value by no less than `2^-104`, which stays normal as well.
//! - **Overflow.** Differences are below `2^202`, so four of them multiply to less than `2^808`. All sums have fewer than
//!   2^12 such terms, and splitting a number multiplies it by `2^27`: at most `2^847`.
//!
//! Points outside the window are first multiplied by a power of two that brings the largest coordinate to its upper
//! end. That does not change a sign, and it rounds nothing unless a coordinate falls below the window.

use crate::Sign;
use glam::DVec2;

/// The window of exponents: `2^LOWEST <= |x| < 2^(HIGHEST + 1)`.
const LOWEST: i32 = -140;
const HIGHEST: i32 = 199;

/// Two to the `exponent`, which must lie between -1022 and 1023.
#[inline(always)]
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The power of two of a finite number that is not zero.
fn exponent(x: f64) -> i32 {
    let bits = x.to_bits() & (u64::MAX >> 1);
    match (bits >> 52) as i32 {
        0 => bits.ilog2() as i32 - 1074,
        biased => biased - 1023,
    }
}

/// The points times a power of two, exactly, with all coordinates in the window; `None` if they do not fit or are not
/// finite.
fn in_window<const N: usize>(points: [DVec2; N]) -> Option<[DVec2; N]> {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for x in points.iter().flat_map(|p| [p.x, p.y]) {
        if x != 0.0 {
            low = low.min(exponent(x));
            high = high.max(exponent(x));
        }
    }
    if high < low || (low >= LOWEST && high <= HIGHEST) {
        return Some(points);
    }
    let shift = HIGHEST - high;
    if high > 1023 || low + shift < LOWEST {
        return None;
    }
    // In two steps, since the factor itself may be too large for a double.
    let (first, second) = (power_of_two(shift / 2), power_of_two(shift - shift / 2));
    Some(points.map(|p| p * first * second))
}

fn coordinates(p: DVec2) -> robust::Coord<f64> {
    robust::Coord { x: p.x, y: p.y }
}

/// orient2d by expansions, if the points fit the proven window.
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let [a, b, c] = in_window([a, b, c])?.map(coordinates);
    Some(Sign::of(robust::orient2d(a, b, c)))
}

/// incircle by expansions, if the points fit the proven window.
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let [a, b, c, d] = in_window([a, b, c, d])?.map(coordinates);
    Some(Sign::of(robust::incircle(a, b, c, d)))
}
