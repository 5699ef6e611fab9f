//! Who goes first where several points want the same container.
//!
//! One 64-bit number a point, the least wins: first a bit that is clear for a point on an edge, then 31 bits of its
//! distance to the container's center, then 32 bits of [`priority`], so that two points never tie.
//!
//! The distance steers, so it is integer arithmetic: coordinates are cut to multiples of a power of two, 2⁻⁵⁸ times
//! the largest of them, and the sum of |dx| and |dy| is then exact. It is the distance times the number of the container's corners (three for
//! a triangle, two for an edge or a ghost triangle), and is kept as 12 bits of exponent and 19 bits of fraction, cut off:
//! such numbers are ordered as the distances are, whatever their power of two was.

use glam::DVec2;
use polder_flip::priority;

/// The key of a point in a container with these corners, one to three.
pub(super) fn key(point: u32, p: DVec2, corners: &[DVec2], on_edge: bool) -> u64 {
    let not_on_edge = u64::from(!on_edge) << 63;
    not_on_edge | u64::from(distance(p, corners)) << 32 | u64::from(priority(point))
}

/// The distance from `p` to the center of the corners, times their number, as exponent and fraction.
fn distance(p: DVec2, corners: &[DVec2]) -> u32 {
    let all = || corners.iter().chain(std::iter::once(&p)).flat_map(|q| q.to_array());
    let top = all().map(top).max().unwrap_or(0);
    let n = corners.len() as i64;
    let along = |k: usize| {
        let sum: i64 = corners.iter().map(|q| fixed(q[k], top)).sum();
        (n * fixed(p[k], top) - sum).unsigned_abs()
    };
    let distance = along(0) + along(1);
    if distance == 0 {
        return 0;
    }
    let bits = 64 - distance.leading_zeros();
    // Below its leading bit, which the exponent says.
    let fraction = (distance << (64 - bits) << 1 >> 45) as u32;
    let exponent = (top + bits as i32 + OFFSET) as u32;
    exponent << 19 | fraction
}

/// Makes exponents positive: `top` is at least -1074.
const OFFSET: i32 = 1075;
/// The cut-off place is this many bits below the top.
const PLACES: i32 = 58;

/// An exponent with |x| < 2 to its power, at least -1074.
fn top(x: f64) -> i32 {
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i32;
    exponent.max(1) - 1022
}

/// x times 2 to the power of `PLACES - top`, cut off to an integer below 2^58 in magnitude.
fn fixed(x: f64, top: i32) -> i64 {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    // x is the mantissa times 2 to the power of exponent - 1075, or -1074 if subnormal.
    let shift = exponent.max(1) - 1075 + PLACES - top;
    let magnitude = if shift >= 0 { mantissa << shift } else { mantissa >> (-shift).min(63) };
    if bits >> 63 == 1 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn fixed_keeps_every_bit_near_the_top() {
        for x in [1.0, -1.0, 0.75, 1.0 + f64::EPSILON, f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.0, -0.0] {
            let top = top(x);
            let back = fixed(x, top);
            assert!(back.unsigned_abs() < 1 << PLACES, "{x}");
            // Powers of two in two halves, since one alone may be out of range.
            let scale = PLACES - top;
            let half = 2f64.powi(scale / 2);
            assert_eq!(x * half * 2f64.powi(scale - scale / 2), back as f64, "{x}");
        }
        assert_eq!(fixed(1e-300, top(1e300)), 0);
    }

    #[test]
    fn distances_are_ordered_across_scales() {
        let corners = [DVec2::new(0.0, 0.0), DVec2::new(3.0, 0.0), DVec2::new(0.0, 3.0)];
        let at = |d: f64| distance(DVec2::new(1.0 + d, 1.0), &corners);
        assert_eq!(at(0.0), 0);
        let steps: Vec<u32> = (-40..12).map(|e| at(2f64.powi(e))).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        assert!(at(1.0) < at(1.0001) && at(1.0001) < at(1.5));
    }

    #[test]
    fn keys_put_edges_first_and_never_tie() {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let near = key(0, DVec2::splat(0.3), &corners, false);
        let far = key(1, DVec2::splat(0.5), &corners[1..], true);
        assert!(far < near);
        let tied: Vec<u64> = (0..100).map(|i| key(i, DVec2::splat(0.3), &corners, false)).collect();
        let mut sorted = tied.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), tied.len());
    }

    #[test]
    fn extreme_magnitudes_do_not_overflow() {
        let m = f64::MAX;
        let corners = [DVec2::new(m, m), DVec2::new(m, -m), DVec2::new(-m, m)];
        let one = distance(DVec2::new(-m, -m), &corners);
        assert!(one < 1 << 31);
        let tiny = DVec2::splat(f64::from_bits(1));
        assert!(distance(tiny, &[DVec2::ZERO, -tiny, tiny]) < one);
    }
}
