//! Machine integers: coordinates that are multiples of a common power of two, as lattices, quantized data and most
//! close calls on ordinary data are.
//!
//! Let `2^e` be the power of two of the largest coordinate of the call.
//!
//! - **Small**: all coordinates are multiples of `2^(e-28)`. They become integers below `2^29`, differences below
//!   `2^30`. orient2d then fits `i64` (`2 * 2^60`), incircle `i128`: liftings and minors below `2^61`, the three
//!   products together below `3 * 2^122`.
//! - **Wide**: all are multiples of `2^(e-59)`. They become integers below `2^60`, differences below `2^61`. orient2d
//!   fits `i128` (`2 * 2^122`), incircle needs 256 bits: liftings and minors below `2^123`, the three products together
//!   below `3 * 2^246`.
//!
//! The conversion adds `1.5 * 2^52` times the unit to a coordinate. That rounds it to a multiple of the unit, whose
//! integer then stands, in two's complement, in the low bits of the sum. What the rounding leaves over is exact in
//! `f64`; it must be zero, or goes the same way again with a unit that is smaller by `2^31`.

use crate::Sign;
use glam::DVec2;

/// `1.5 * 2^exponent`.
#[inline(always)]
fn shifter(exponent: i32) -> f64 {
    f64::from_bits((((exponent + 1023) as u64) << 52) | (1 << 51))
}

/// `p` rounded to a multiple of the unit of `shifter`: as an integer, and what is left over.
#[inline(always)]
fn split(p: DVec2, shifter: f64) -> ([i64; 2], DVec2) {
    let shifted = p + shifter;
    let low_bits = |x: f64| i64::from(x.to_bits() as i32);
    ([low_bits(shifted.x), low_bits(shifted.y)], p - (shifted - shifter))
}

#[inline(always)]
fn larger(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// What is not zero makes the sum not zero: nothing underflows in a sum. NaN stays.
#[inline(always)]
fn all_zero<const N: usize>(points: [DVec2; N]) -> bool {
    let sum = points.into_iter().fold(DVec2::ZERO, |sum, p| sum + p.abs());
    sum.x + sum.y == 0.0
}

/// Points rounded to multiples of `2^(exponent - 28)`, as integers below `2^29`, with what is left over.
#[derive(Clone, Copy)]
struct Rounded<const N: usize> {
    exponent: i32,
    integers: [[i64; 2]; N],
    rest: [DVec2; N],
}

impl<const N: usize> Rounded<N> {
    /// `None` outside the range of exponents in which both shifters are normal numbers; zeros alone end here as well.
    #[inline(always)]
    fn new(points: [DVec2; N]) -> Option<Self> {
        let largest =
            points.iter().fold(DVec2::ZERO, |m, p| DVec2::new(larger(p.x.abs(), m.x), larger(p.y.abs(), m.y)));
        let exponent = ((larger(largest.x, largest.y).to_bits() >> 52) & 0x7ff) as i32 - 1023;
        if !(-1015..=999).contains(&exponent) {
            return None;
        }
        let shifter = shifter(exponent + 24);
        let pairs = points.map(|p| split(p, shifter));
        Some(Self { exponent, integers: pairs.map(|p| p.0), rest: pairs.map(|p| p.1) })
    }

    /// As integers below `2^60`, in units of `2^(exponent - 59)`, if they are.
    #[inline(always)]
    fn finer(self) -> Option<[[i64; 2]; N]> {
        let shifter = shifter(self.exponent - 7);
        let pairs = self.rest.map(|p| split(p, shifter));
        let mut integers = self.integers;
        for (integer, ([x, y], _)) in integers.iter_mut().zip(&pairs) {
            *integer = [(integer[0] << 31) + x, (integer[1] << 31) + y];
        }
        if all_zero(pairs.map(|p| p.1)) { Some(integers) } else { None }
    }
}

#[inline(always)]
fn minus(p: [i64; 2], q: [i64; 2]) -> [i64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

#[inline(always)]
fn product(x: i64, y: i64) -> i128 {
    i128::from(x) * i128::from(y)
}

#[inline(always)]
fn small_cross(p: [i64; 2], q: [i64; 2]) -> i64 {
    p[0] * q[1] - p[1] * q[0]
}

#[inline(always)]
fn wide_cross(p: [i64; 2], q: [i64; 2]) -> i128 {
    product(p[0], q[1]) - product(p[1], q[0])
}

/// orient2d by machine integers, if the coordinates are multiples of a common power of two not too far below them.
#[inline(always)]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let rounded = Rounded::new([a, b, c])?;
    if !all_zero(rounded.rest) {
        return orient2d_wide(&rounded);
    }
    let [a, b, c] = rounded.integers;
    Some(Sign::of(small_cross(minus(a, c), minus(b, c))))
}

#[inline(never)]
fn orient2d_wide(rounded: &Rounded<3>) -> Option<Sign> {
    let [a, b, c] = rounded.finer()?;
    Some(Sign::of(wide_cross(minus(a, c), minus(b, c))))
}

/// incircle by machine integers, if the coordinates are multiples of a common power of two not too far below them.
#[inline(always)]
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let rounded = Rounded::new([a, b, c, d])?;
    if !all_zero(rounded.rest) {
        return incircle_wide(&rounded);
    }
    let [a, b, c, d] = rounded.integers;
    let (a, b, c) = (minus(a, d), minus(b, d), minus(c, d));
    let term = |p: [i64; 2], q, r| product(p[0] * p[0] + p[1] * p[1], small_cross(q, r));
    Some(Sign::of(term(a, b, c) + term(b, c, a) + term(c, a, b)))
}

#[inline(never)]
fn incircle_wide(rounded: &Rounded<4>) -> Option<Sign> {
    let [a, b, c, d] = rounded.finer()?;
    let (a, b, c) = (minus(a, d), minus(b, d), minus(c, d));
    let term = |p: [i64; 2], q, r| {
        let lifting = product(p[0], p[0]) + product(p[1], p[1]);
        Wide::product(lifting as u128, wide_cross(q, r))
    };
    Some(term(a, b, c).plus(term(b, c, a)).plus(term(c, a, b)).sign())
}

/// A signed integer of 256 bits, two's complement.
#[derive(Clone, Copy)]
struct Wide {
    high: i128,
    low: u128,
}

impl Wide {
    #[inline(always)]
    fn product(x: u128, y: i128) -> Self {
        const LOW: u128 = u64::MAX as u128;
        let magnitude = y.unsigned_abs();
        let (x1, x0) = (x >> 64, x & LOW);
        let (y1, y0) = (magnitude >> 64, magnitude & LOW);
        let lowest = x0 * y0;
        // x1 and y1 are below 2^59 here, so the sum cannot overflow.
        let middle = x1 * y0 + x0 * y1 + (lowest >> 64);
        let low = (middle << 64) | (lowest & LOW);
        let high = (x1 * y1 + (middle >> 64)) as i128;
        if y < 0 { Self { high: !high + i128::from(low == 0), low: low.wrapping_neg() } } else { Self { high, low } }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self { high: self.high + other.high + i128::from(carry), low }
    }

    #[inline(always)]
    fn sign(self) -> Sign {
        if self.high < 0 {
            Sign::Negative
        } else if self.high == 0 && self.low == 0 {
            Sign::Zero
        } else {
            Sign::Positive
        }
    }
}
