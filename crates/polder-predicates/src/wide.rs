//! Floating-point numbers whose exponents cannot run out: points that are far apart in magnitude, but not nearly on one
//! line or circle.
//!
//! A mantissa and an exponent in an `i32` stand for `m * 2^e`, with `1 <= |m| < 2` for each difference of coordinates and
//! less than 16 for a product of four. The determinant is a sum of 2 products of two differences (orient2d) or 12 products
//! of four (incircle). Relative to the largest of them they fit plain `f64` again, and the sum of their absolute values
//! bounds the error as in [`filter`](crate::filter), without a term for underflow and without overflow.
//!
//! # Steps
//!
//! 1. The differences to one point, the *base*, each with its exponent.
//! 2. The products: mantissas multiply, exponents add.
//! 3. All products in units of `2^top`, for the largest exponent `top` of a product that is not zero, and their sum.
//! 4. If the sum is closer to zero than its error bound: again with another point as the base. Points around the base
//!    keep their bits; points far from the base and close to each other lose them. So three tiny points and one
//!    far away are decided from any of the tiny ones, and not from the far one.
//!
//! # Why a sign it returns is right, for every input
//!
//! Let `u = 2^-53`.
//!
//! 1. *A difference* `D` of two coordinates is stored as `D (1 + δ)`, `|δ| ≤ u + 2^-2000`. Sums do not underflow, so this
//!    holds whenever `p - q` does not overflow, and a subnormal difference times `2^64` is normal and exact. If `p - q`
//!    overflows, then `p/2 - q/2` does not, and the larger of the two is at least `2^1022`, so its half is exact. The half
//!    of the other is off by no more than `2^-1075`, which is less than `2^-2000` of the result. A difference is zero only
//!    if it is exactly zero.
//! 2. *A product* of `k` differences takes `k - 1` roundings of mantissas, which neither overflow nor underflow. So the
//!    product `t` for the exact `T` has `|t - T| ≤ ((1 + u)^(2k-1) - 1) |T|`, up to a factor `1 + 2^-1900`.
//! 3. *In units of* `2^top`, a product of exponent `top - 1000` or more is exact. One below that is taken as if its exponent
//!    were `top - 1000`: an error below `16 * 2^-1000`. The largest product is at least 1, and so is the sum of absolute
//!    values, so that 12 of these errors are less than `2^-900` of it.
//! 4. *The sum*: each product goes through at most one addition in orient2d, four in incircle. Let `S` be the sum of the
//!    `|T|` in units of `2^top`, `s` its computed value and `v` that of the determinant `E`. Then
//!    `|v - E| ≤ ((1 + u)^n - 1 + 2^-899) S` and `|s - S|` likewise, with `n = 3 + 1` in orient2d and `n = 7 + 4` in
//!    incircle. So `|v - E| ≤ 4.01 u s` and `|v - E| ≤ 11.01 u s`.
//!
//! The bounds used, `5 u s` and `12 u s`, are larger also after their own rounding. If `s` is zero, then so is every
//! product, exactly, and the determinant. A coordinate that is not finite makes a mantissa, and thereby `v` and `s`, NaN;
//! no comparison with these holds, and the answer is `None`.
//!
//! Exchanging two points changes the sign, so a cyclic shift of three points keeps it and one of four reverses it: that
//! is how the base changes.

use crate::Sign;
use crate::expansions::power_of_two;
use glam::DVec2;

/// The bound of orient2d: 5 u for u = 2^-53.
pub const ORIENT2D_BOUND: f64 = 2.5 * f64::EPSILON;
/// The bound of incircle: 12 u for u = 2^-53.
pub const INCIRCLE_BOUND: f64 = 6.0 * f64::EPSILON;
/// The exponent that goes with a zero: four of them fit an `i32`, and one outweighs the exponents of any three others.
const ZERO: i32 = -100_000;
/// A product that is smaller than the largest by a higher power of two than this counts as smaller by this one.
const DEPTH: i32 = 1000;

/// `mantissa * 2^exponent`.
#[derive(Clone, Copy)]
struct Wide {
    mantissa: f64,
    exponent: i32,
}

/// The eleven bits of the exponent.
#[inline(always)]
fn biased_exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32
}

impl Wide {
    /// `x * 2^exponent` for a normal `x`.
    #[inline(always)]
    fn normalized(x: f64, exponent: i32) -> Self {
        let mantissa = f64::from_bits((x.to_bits() & !(0x7ff << 52)) | (1023 << 52));
        Self { mantissa, exponent: biased_exponent(x) - 1023 + exponent }
    }

    /// `p - q`, rounded.
    #[inline(always)]
    fn difference(p: f64, q: f64) -> Self {
        let difference = p - q;
        match biased_exponent(difference) {
            0 | 0x7ff => Self::unusual_difference(p, q),
            _ => Self::normalized(difference, 0),
        }
    }

    /// `p - q` if that is zero, subnormal, too large, or not finite at all.
    #[cold]
    #[inline(never)]
    fn unusual_difference(p: f64, q: f64) -> Self {
        let difference = p - q;
        if difference == 0.0 {
            return Self { mantissa: 0.0, exponent: ZERO };
        }
        if difference.is_finite() {
            return Self::normalized(difference * power_of_two(64), -64);
        }
        let half = 0.5 * p - 0.5 * q;
        if half.is_finite() { Self::normalized(half, 1) } else { Self { mantissa: f64::NAN, exponent: 0 } }
    }
}

impl std::ops::Mul for Wide {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { mantissa: self.mantissa * other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl std::ops::Neg for Wide {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, exponent: self.exponent }
    }
}

/// The terms in units of the power of two of the largest.
#[inline(always)]
fn in_units_of_the_largest<const N: usize>(terms: [Wide; N]) -> [f64; N] {
    let top = terms.iter().fold(i32::MIN, |top, term| top.max(term.exponent));
    terms.map(|term| term.mantissa * power_of_two((term.exponent - top).max(-DEPTH)))
}

/// A determinant and the sum of the absolute values of its terms, both in units of the same power of two and rounded.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The determinant.
    pub value: f64,
    /// The sum of the absolute values of the products that it is the sum of.
    pub magnitude: f64,
}

impl Estimate {
    /// The sign, if the error of the value is less than `bound` times the magnitude and that suffices to know it.
    #[inline(always)]
    pub fn sign(self, bound: f64) -> Option<Sign> {
        if self.value.abs() > bound * self.magnitude {
            Some(if self.value > 0.0 { Sign::Positive } else { Sign::Negative })
        } else if self.magnitude == 0.0 {
            Some(Sign::Zero)
        } else {
            None
        }
    }
}

/// The orientation of `abc` with `c` as the base. Its error is below 4.01 u of the magnitude.
#[inline(always)]
pub fn estimate_orient2d(a: DVec2, b: DVec2, c: DVec2) -> Estimate {
    let left = Wide::difference(a.x, c.x) * Wide::difference(b.y, c.y);
    let right = Wide::difference(a.y, c.y) * Wide::difference(b.x, c.x);
    let [left, right] = in_units_of_the_largest([left, -right]);
    Estimate { value: left + right, magnitude: left.abs() + right.abs() }
}

/// The in-circle determinant with `d` as the base. Its error is below 11.01 u of the magnitude.
pub fn estimate_incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Estimate {
    let [(ax, ay), (bx, by), (cx, cy)] = [a, b, c].map(|p| (Wide::difference(p.x, d.x), Wide::difference(p.y, d.y)));

    let (bxcy, cxby) = (bx * cy, -(cx * by));
    let (cxay, axcy) = (cx * ay, -(ax * cy));
    let (axby, bxay) = (ax * by, -(bx * ay));

    let (axax, ayay) = (ax * ax, ay * ay);
    let (bxbx, byby) = (bx * bx, by * by);
    let (cxcx, cycy) = (cx * cx, cy * cy);

    let terms = in_units_of_the_largest([
        axax * bxcy,
        axax * cxby,
        ayay * bxcy,
        ayay * cxby,
        bxbx * cxay,
        bxbx * axcy,
        byby * cxay,
        byby * axcy,
        cxcx * axby,
        cxcx * bxay,
        cycy * axby,
        cycy * bxay,
    ]);
    Estimate { value: sum(terms), magnitude: sum(terms.map(f64::abs)) }
}

/// No term goes through more than four additions.
#[inline(always)]
fn sum(terms: [f64; 12]) -> f64 {
    let column = |k: usize| terms[k] + terms[k + 4] + terms[k + 8];
    (column(0) + column(1)) + (column(2) + column(3))
}

/// orient2d, if the roundings leave no doubt with one of the points as the base.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, wide};
///
/// let (a, b) = (dvec2(1e300, 0.0), dvec2(0.0, 1e-300));
/// assert_eq!(wide::orient2d(a, b, dvec2(1e-300, 0.0)), Some(Sign::Positive));
/// ```
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let from = |a, b, c| estimate_orient2d(a, b, c).sign(ORIENT2D_BOUND);
    from(a, b, c).or_else(|| from(b, c, a)).or_else(|| from(c, a, b))
}

/// incircle, if the roundings leave no doubt with one of the points as the base.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, wide};
///
/// // From far away the three corners look like one point. From any of them it is plain that d is outside.
/// let [a, b, c] = [dvec2(0.0, 0.0), dvec2(1e-300, 0.0), dvec2(0.0, 1e-300)];
/// assert_eq!(wide::incircle(a, b, c, dvec2(1e300, 1e200)), Some(Sign::Negative));
/// ```
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let from = |a, b, c, d| estimate_incircle(a, b, c, d).sign(INCIRCLE_BOUND);
    from(a, b, c, d)
        .or_else(|| from(b, c, d, a).map(|sign| -sign))
        .or_else(|| from(c, d, a, b))
        .or_else(|| from(d, a, b, c).map(|sign| -sign))
}
