//! Who goes first where several points want the same container.
//!
//! One 64-bit number a point, the least wins: first a bit that is clear for a point on an edge, then 31 bits that say
//! how well the point suits, the *score*, then 32 bits of [`precedence`], so that two points never tie.
//!
//! - In a triangle all points suit alike, so that chance decides. Whatever the points look like, each part of the split
//!   triangle is then expected to get a fraction of them. Every rule that looks at the triangle has its family of
//!   points that it serves badly, by taking them from the border of the crowd inwards: nearest to the center needs 538
//!   rounds for 200,000 points on four circles, and 57 for points that crowd toward (1/2, 1/2), where chance needs 20 and
//!   23. What chance costs is two rounds more for a cluster.
//! - On an edge the point nearest to the middle goes first: points on an edge are often evenly spread.
//! - Outside the hull it is the one highest above the hull edge: most of the others are inside afterwards, where the
//!   nearest would leave them outside, in sectors hardly narrower; and of points along an arc the highest is in the
//!   middle, where the one farthest from the edge's middle is at an end.
//!
//! This steers, so it is integer arithmetic. Coordinates are cut off to multiples of a power of two, 2⁻⁵⁸ times the
//! power of two above the largest of them. Twice the sum of |dx| and |dy| from the middle is then exact, and so is the
//! height, times the edge's length: twice the area of the triangle. They are kept as an exponent and a fraction, cut off
//! after 31 bits in all: such numbers are ordered as what they stand for, whatever their powers of two were.

use glam::DVec2;

/// Who goes first where scores do not tell: chance, in layers. Of every two numbers `2 k` and `2 k + 1` one is in the lower half,
/// of every four from `4 k` one in the lowest quarter, and so on. Points that crowd have numbers in a row, often along a line:
/// so the first of them to go are spread evenly, and those of the next layer lie between them, one or two to a triangle. A
/// bijection: the bits reversed, each then changed by those below it.
pub(super) fn precedence(point: u32) -> u32 {
    let mut x = point.reverse_bits().wrapping_add(0x5bd1_e995);
    for factor in [0x6c50_b47c_u32, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(factor);
    }
    x
}

/// The score of every point strictly inside a triangle; of points on an edge it is less, outside the hull not less.
pub(crate) const INSIDE: u32 = 1 << 31;

/// The score of a point strictly between the ends of an edge.
pub(crate) fn on_edge(p: DVec2, [u, w]: [DVec2; 2]) -> u32 {
    let top = largest_top([p, u, w]);
    let along = |k: usize| (2 * fixed(p[k], top) - fixed(u[k], top) - fixed(w[k], top)).unsigned_abs();
    float(u128::from(along(0) + along(1)), top + 1200, 19)
}

/// The score of a point in the sector of a hull edge.
pub(crate) fn outside(p: DVec2, [u, w]: [DVec2; 2]) -> u32 {
    u32::MAX - area(p, u, w)
}

/// Twice the area of the triangle between an edge and a point outside of it, zero if cut-off coordinates turn it round.
fn area(p: DVec2, u: DVec2, w: DVec2) -> u32 {
    let top = largest_top([p, u, w]);
    let to = |q: DVec2, k: usize| i128::from(fixed(q[k], top) - fixed(u[k], top));
    // Positive where the point lies right of the edge, as it does outside.
    let area = to(w, 1) * to(p, 0) - to(w, 0) * to(p, 1);
    float(u128::try_from(area).unwrap_or(0), 2 * top + 2400, 18)
}

/// A number as its exponent, counted from one below `-base`, and so many bits of its fraction; zero for zero.
fn float(x: u128, base: i32, fraction_bits: u32) -> u32 {
    if x == 0 {
        return 0;
    }
    let bits = 128 - x.leading_zeros();
    // Below its leading bit, which the exponent says.
    let fraction = x.checked_shl(129 - bits).unwrap_or(0) >> (128 - fraction_bits);
    ((base + bits as i32) as u32) << fraction_bits | fraction as u32
}

fn largest_top(points: [DVec2; 3]) -> i32 {
    points.into_iter().flat_map(|q| q.to_array()).map(top).max().unwrap_or(0)
}

/// The cut-off place is this many bits below the top.
const PLACES: i32 = 58;

/// An exponent with |x| < 2 to its power, between -1021 and 1024.
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
    fn precedence_is_a_bijection_in_layers() {
        for layer in 0..16_u32 {
            for k in (0..1 << 16).step_by(1 << layer) {
                let mut parts: Vec<u32> = (0..1 << layer).map(|i| precedence(k + i) >> (32 - layer).min(31)).collect();
                parts.sort_unstable();
                assert!(layer == 0 || parts.into_iter().eq(0..1 << layer), "{layer} {k}");
            }
        }
        let mut all: Vec<u32> = (0..1 << 20).map(|i: u32| precedence(i.wrapping_mul(4099))).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 1 << 20);
    }

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
        let at = |d: f64| on_edge(DVec2::new(1.0 + d, 1.0), [DVec2::ZERO, DVec2::splat(2.0)]);
        assert_eq!(at(0.0), 0);
        let steps: Vec<u32> = (-40..12).map(|e| at(2f64.powi(e))).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        assert!(at(1.0) < at(1.0001) && at(1.0001) < at(1.5));
    }

    #[test]
    fn heights_are_ordered_across_scales() {
        let at = |height: f64| outside(DVec2::new(0.25, height), [DVec2::X, DVec2::ZERO]);
        let steps: Vec<u32> = (-50..50).map(|e| at(2f64.powi(e))).collect();
        assert!(steps.windows(2).all(|pair| pair[0] > pair[1]), "{steps:?}");
        assert!(steps.iter().all(|&score| score > INSIDE));
    }

    #[test]
    fn edges_go_before_what_is_inside() {
        let [b, c] = [DVec2::X, DVec2::Y];
        assert!(on_edge(DVec2::new(0.75, 0.25), [b, c]) < INSIDE);
        assert!(outside(DVec2::new(9.0, 9.0), [b, c]) < outside(DVec2::new(1.0, 1.0), [b, c]));
    }

    #[test]
    fn extreme_magnitudes_do_not_overflow() {
        let m = f64::MAX;
        let one = on_edge(DVec2::new(-m, -m), [DVec2::new(m, m), DVec2::new(m, -m)]);
        assert!(one < INSIDE);
        let tiny = DVec2::splat(f64::from_bits(1));
        assert!(on_edge(tiny, [DVec2::ZERO, -tiny]) < one);
        assert!(outside(DVec2::new(m, m), [DVec2::new(m, -m), DVec2::new(-m, m)]) >= INSIDE);
    }
}
