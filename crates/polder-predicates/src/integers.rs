//! Machine integers: coordinates that are multiples of a common power of two, as lattices, quantized data and most
//! close calls on ordinary data are.
//!
//! Two sizes, both exact whenever they answer:
//!
//! - **small**: the differences to the last point are exact in `f64` and multiples of `2^-29` of the largest one's
//!   power of two. They become integers below `2^30`. orient2d then fits `i64` (`2 * 2^60`), incircle `i128`: lifting
//!   and minor below `2^61`, three products below `3 * 2^122`.
//! - **wide**: the coordinates are multiples of `2^-60` of the largest one's power of two. They become integers below
//!   `2^61`, differences below `2^62`; orient2d fits `i128` (`2 * 2^124`), incircle needs 256 bits: lifting and minor
//!   below `2^125`, three products below `3 * 2^250`.
//!
//! Scaling is exact: `x * 2^k` is converted to an integer, and the integer times `2^-k` must be `x` again, so that
//! neither a fraction nor an underflow goes unnoticed.

use crate::Sign;
use glam::DVec2;

/// Two to the `exponent`, which must lie between -1022 and 1023.
#[inline]
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The power of two of a normal number; -1023 for zero and subnormals, 1024 for what is not finite.
#[inline]
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// All of `values` times one power of two, as integers below `2^bits` in absolute value, if they are integers.
#[inline(always)]
fn scaled<const N: usize, T: Copy + Default>(
    values: [f64; N],
    bits: i32,
    convert: impl Fn(f64) -> (T, f64),
) -> Option<[T; N]> {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut integers = [T::default(); N];
    if largest == 0.0 {
        return Some(integers);
    }
    let top = exponent(largest);
    // Outside, the two factors below would not be normal numbers.
    if !(bits - 1024..=1023).contains(&top) {
        return None;
    }
    let scale = power_of_two(bits - 1 - top);
    let back = power_of_two(top + 1 - bits);
    for (integer, value) in integers.iter_mut().zip(values) {
        let (t, rounded) = convert(value * scale);
        *integer = t;
        if rounded * back != value {
            return None;
        }
    }
    Some(integers)
}

/// `x` rounded to an integer, for `|x| < 2^31`: adding 1.5 * 2^52 leaves it in the low bits of the sum.
#[inline(always)]
fn to_small(x: f64) -> (i64, f64) {
    const SHIFTER: f64 = 6_755_399_441_055_744.0;
    let shifted = x + SHIFTER;
    (i64::from(shifted.to_bits() as i32), shifted - SHIFTER)
}

#[inline(always)]
fn to_wide(x: f64) -> (i64, f64) {
    let integer = x as i64;
    (integer, integer as f64)
}

/// `p - q`, if it is a double.
#[inline(always)]
fn exact_difference(p: f64, q: f64) -> Option<f64> {
    // If |p| >= |q|, p - d is computed exactly, otherwise d + q is: both hold only for the true difference.
    let d = p - q;
    if p - d == q && d + q == p { Some(d) } else { None }
}

/// orient2d from differences that are small integers times a power of two.
#[inline(always)]
pub fn orient2d_small(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let differences = [
        exact_difference(a.x, c.x)?,
        exact_difference(a.y, c.y)?,
        exact_difference(b.x, c.x)?,
        exact_difference(b.y, c.y)?,
    ];
    let [ax, ay, bx, by] = scaled(differences, 30, to_small)?;
    Some(Sign::of(ax * by - ay * bx))
}

/// incircle from differences that are small integers times a power of two.
#[inline(always)]
pub fn incircle_small(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let differences = [
        exact_difference(a.x, d.x)?,
        exact_difference(a.y, d.y)?,
        exact_difference(b.x, d.x)?,
        exact_difference(b.y, d.y)?,
        exact_difference(c.x, d.x)?,
        exact_difference(c.y, d.y)?,
    ];
    let [ax, ay, bx, by, cx, cy] = scaled(differences, 30, to_small)?;
    let term = |lifting: i64, minor: i64| i128::from(lifting) * i128::from(minor);
    let value = term(ax * ax + ay * ay, bx * cy - cx * by)
        + term(bx * bx + by * by, cx * ay - ax * cy)
        + term(cx * cx + cy * cy, ax * by - bx * ay);
    Some(Sign::of(value))
}

#[inline(always)]
fn product(x: i64, y: i64) -> i128 {
    i128::from(x) * i128::from(y)
}

/// orient2d from coordinates that are integers of 61 bits times a power of two.
#[inline(always)]
pub fn orient2d_wide(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let [ax, ay, bx, by, cx, cy] = scaled([a.x, a.y, b.x, b.y, c.x, c.y], 61, to_wide)?;
    Some(Sign::of(product(ax - cx, by - cy) - product(ay - cy, bx - cx)))
}

/// incircle from coordinates that are integers of 61 bits times a power of two.
#[inline(always)]
pub fn incircle_wide(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let [ax, ay, bx, by, cx, cy, dx, dy] = scaled([a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y], 61, to_wide)?;
    let (ax, ay, bx, by, cx, cy) = (ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy);
    let lifting = |x: i64, y: i64| (product(x, x) + product(y, y)) as u128;
    let minor = |px: i64, py: i64, qx: i64, qy: i64| product(px, qy) - product(qx, py);
    let value = Wide::product(lifting(ax, ay), minor(bx, by, cx, cy))
        .plus(Wide::product(lifting(bx, by), minor(cx, cy, ax, ay)))
        .plus(Wide::product(lifting(cx, cy), minor(ax, ay, bx, by)));
    Some(value.sign())
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
        let magnitude = y.unsigned_abs();
        let (x1, x0) = (x >> 64, x & u128::from(u64::MAX));
        let (y1, y0) = (magnitude >> 64, magnitude & u128::from(u64::MAX));
        // x1 and y1 are below 2^61 here, so the middle sum cannot overflow.
        let middle = x1 * y0 + x0 * y1 + ((x0 * y0) >> 64);
        let low = (middle << 64) | ((x0 * y0) & u128::from(u64::MAX));
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
