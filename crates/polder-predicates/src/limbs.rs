//! Fixed-point integers of `u32` limbs: exact for every finite `f64`, whatever its magnitude.
//!
//! This is the last resort on a CPU, and rests on nothing but 32-bit words, additions and subtractions with carry, and
//! products of two words with a high and a low half; no allocation, no recursion. Kernels have less memory to spare: their
//! integers sum up products of mantissas from the top.
//!
//! # Steps
//!
//! 1. [`Span::of`]: the exponent of the lowest bit set in any coordinate of the call, and the number `b` of bits from
//!    there to the highest. Every coordinate is an integer below `2^b` times `2^low`, and `low` does not matter for a
//!    sign. Trailing zeros count, so that small integers stay short.
//! 2. Differences to the last point, as sign and magnitude: below `2^(b+1)`.
//! 3. Liftings and minors, accumulated in two's complement: below `2^(2b+3)`, and a sign bit.
//! 4. The sum of three products of these: below `3 * 2^(4b+6) < 2^(4b+8)`, and a sign bit. orient2d ends with step 3.
//!
//! Each call uses as many limbs as its own points need ([`Span::incircle_limbs`]): 2 for an integer lattice of 12 bits,
//! 7 for doubles of equal exponent, 263 for the whole range of `f64`.

use crate::Sign;
use glam::DVec2;

/// Limbs of a difference over the whole range of `f64`.
pub const MAX_DIFFERENCE_LIMBS: usize = 66;
/// Limbs of an orientation, a lifting or a minor over the whole range of `f64`.
pub const MAX_ORIENT2D_LIMBS: usize = 132;
/// Limbs of an in-circle determinant over the whole range of `f64`.
pub const MAX_INCIRCLE_LIMBS: usize = 263;

/// Where the bits of some coordinates lie: they are all multiples of `2^low` and below `2^(low + bits)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Exponent of the lowest bit that is set.
    pub low: i32,
    /// Number of bits from the lowest to the highest that is set, at most 2098; 0 if all coordinates are zero.
    pub bits: u32,
}

impl Span {
    /// The span of the coordinates of `points`; `None` if one is infinite or NaN.
    ///
    /// ```
    /// use glam::dvec2;
    /// use polder_predicates::limbs::Span;
    ///
    /// let span = Span::of(&[dvec2(12.0, 0.0), dvec2(-4.0, 16.0)]);
    /// assert_eq!(span, Some(Span { low: 2, bits: 3 }));
    /// assert_eq!(Span::of(&[dvec2(f64::NAN, 0.0)]), None);
    /// ```
    pub fn of(points: &[DVec2]) -> Option<Self> {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for p in points {
            for x in [p.x, p.y] {
                if !x.is_finite() {
                    return None;
                }
                let (mantissa_high, mantissa_low, exponent) = parts(x);
                if (mantissa_high | mantissa_low) == 0 {
                    continue;
                }
                let trailing = match mantissa_low {
                    0 => 32 + mantissa_high.trailing_zeros(),
                    _ => mantissa_low.trailing_zeros(),
                };
                let length = match mantissa_high {
                    0 => 32 - mantissa_low.leading_zeros(),
                    _ => 64 - mantissa_high.leading_zeros(),
                };
                low = low.min(exponent + trailing as i32);
                high = high.max(exponent + length as i32);
            }
        }
        if high < low { Some(Self { low: 0, bits: 0 }) } else { Some(Self { low, bits: (high - low) as u32 }) }
    }

    /// Limbs of a difference of two coordinates, as a magnitude.
    pub fn difference_limbs(self) -> usize {
        limbs_for(self.bits + 1)
    }

    /// Limbs of an orientation, a lifting or a minor, in two's complement.
    pub fn orient2d_limbs(self) -> usize {
        limbs_for(2 * self.bits + 4)
    }

    /// Limbs of an in-circle determinant, in two's complement.
    ///
    /// ```
    /// use glam::dvec2;
    /// use polder_predicates::limbs::{MAX_INCIRCLE_LIMBS, Span};
    ///
    /// let whole_range = Span::of(&[dvec2(f64::MAX, 0.0), dvec2(-5e-324, 1.0)]);
    /// assert_eq!(whole_range.map(Span::incircle_limbs), Some(MAX_INCIRCLE_LIMBS));
    /// ```
    pub fn incircle_limbs(self) -> usize {
        limbs_for(4 * self.bits + 9)
    }
}

fn limbs_for(bits: u32) -> usize {
    bits.div_ceil(32) as usize
}

/// The exact orientation of `abc`; zero if a coordinate is infinite or NaN.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, limbs};
///
/// let (a, b) = (dvec2(0.0, 0.0), dvec2(1e300, 1e300));
/// assert_eq!(limbs::orient2d(a, b, dvec2(0.0, 5e-324)), Sign::Positive);
/// ```
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    let Some(span) = Span::of(&[a, b, c]) else { return Sign::Zero };
    let a = Vector::between(a, c, span);
    let b = Vector::between(b, c, span);
    let mut value = [0; MAX_ORIENT2D_LIMBS];
    let value = &mut value[..span.orient2d_limbs()];
    a.cross(&b, value);
    sign(value)
}

/// The exact in-circle sign of `d` and `abc`; zero if a coordinate is infinite or NaN.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, limbs};
///
/// let (a, b, c) = (dvec2(-1e300, 0.0), dvec2(1e300, 0.0), dvec2(0.0, 1e300));
/// assert_eq!(limbs::incircle(a, b, c, dvec2(0.0, -1e300)), Sign::Zero);
/// assert_eq!(limbs::incircle(a, b, c, dvec2(5e-324, -1e300)), Sign::Negative);
/// ```
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    let Some(span) = Span::of(&[a, b, c, d]) else { return Sign::Zero };
    let a = Vector::between(a, d, span);
    let b = Vector::between(b, d, span);
    let c = Vector::between(c, d, span);
    let mut value = [0; MAX_INCIRCLE_LIMBS];
    let value = &mut value[..span.incircle_limbs()];
    for (p, q, r) in [(&a, &b, &c), (&b, &c, &a), (&c, &a, &b)] {
        let (mut lifting, mut minor) = ([0; MAX_ORIENT2D_LIMBS], [0; MAX_ORIENT2D_LIMBS]);
        let lifting = &mut lifting[..span.orient2d_limbs()];
        let minor = &mut minor[..span.orient2d_limbs()];
        p.square(lifting);
        q.cross(r, minor);
        let negative = sign(minor) == Sign::Negative;
        if negative {
            negate(minor);
        }
        add_product(value, lifting, minor, negative);
    }
    sign(value)
}

/// The difference of two points, as two signs and magnitudes.
struct Vector {
    limbs: usize,
    x: [u32; MAX_DIFFERENCE_LIMBS],
    y: [u32; MAX_DIFFERENCE_LIMBS],
    x_negative: bool,
    y_negative: bool,
}

impl Vector {
    /// `p - q`, in units of `2^span.low`.
    fn between(p: DVec2, q: DVec2, span: Span) -> Self {
        let limbs = span.difference_limbs();
        let (mut x, mut y) = ([0; MAX_DIFFERENCE_LIMBS], [0; MAX_DIFFERENCE_LIMBS]);
        let x_negative = difference(p.x, q.x, span.low, &mut x[..limbs]);
        let y_negative = difference(p.y, q.y, span.low, &mut y[..limbs]);
        Self { limbs, x, y, x_negative, y_negative }
    }

    fn x(&self) -> &[u32] {
        &self.x[..self.limbs]
    }

    fn y(&self) -> &[u32] {
        &self.y[..self.limbs]
    }

    /// Adds the square of the length to `sum`.
    fn square(&self, sum: &mut [u32]) {
        add_product(sum, self.x(), self.x(), false);
        add_product(sum, self.y(), self.y(), false);
    }

    /// Adds the cross product with `other` to `sum`.
    fn cross(&self, other: &Self, sum: &mut [u32]) {
        add_product(sum, self.x(), other.y(), self.x_negative != other.y_negative);
        add_product(sum, self.y(), other.x(), self.y_negative == other.x_negative);
    }
}

/// The high 21 and the low 32 bits of the mantissa of a finite `x`, and the exponent of the lowest of them.
fn parts(x: f64) -> (u32, u32, i32) {
    let bits = x.to_bits();
    let (high, low) = ((bits >> 32) as u32, bits as u32);
    match (high >> 20) & 0x7ff {
        0 => (high & 0xf_ffff, low, -1074),
        biased => (high & 0xf_ffff | 0x10_0000, low, biased as i32 - 1075),
    }
}

/// A coordinate in units of `2^low`: at most three of its limbs are not zero.
struct Number {
    words: [u32; 3],
    first: usize,
    negative: bool,
}

impl Number {
    fn new(x: f64, low: i32) -> Self {
        let (mut high, mut word, exponent) = parts(x);
        let mut shift = exponent - low;
        if (high | word) == 0 {
            shift = 0;
        }
        // The bits that fall out at the bottom are zero: `low` is at most the exponent of the lowest bit set.
        if shift <= -32 {
            (high, word) = (0, high);
            shift += 32;
        }
        if shift < 0 {
            word = (word >> -shift) | ((high << 1) << (31 + shift));
            high >>= -shift;
            shift = 0;
        }
        let (first, shift) = (shift as usize / 32, shift as u32 % 32);
        let words = [word << shift, (high << shift) | ((word >> 1) >> (31 - shift)), (high >> 1) >> (31 - shift)];
        Self { words, first, negative: x.is_sign_negative() }
    }

    fn limb(&self, k: usize) -> u32 {
        if k >= self.first && k < self.first + 3 { self.words[k - self.first] } else { 0 }
    }
}

/// Writes `|p - q|` in units of `2^low` and returns whether `p - q` is negative (either answer for zero).
fn difference(p: f64, q: f64, low: i32, magnitude: &mut [u32]) -> bool {
    let (p, q) = (Number::new(p, low), Number::new(q, low));
    if p.negative != q.negative {
        let mut carry = 0;
        for (k, limb) in magnitude.iter_mut().enumerate() {
            let (sum, first) = uadd_carry(p.limb(k), q.limb(k));
            let (sum, second) = uadd_carry(sum, carry);
            (*limb, carry) = (sum, first + second);
        }
        return p.negative;
    }
    let mut borrow = 0;
    for (k, limb) in magnitude.iter_mut().enumerate() {
        let (difference, first) = usub_borrow(p.limb(k), q.limb(k));
        let (difference, second) = usub_borrow(difference, borrow);
        (*limb, borrow) = (difference, first + second);
    }
    if borrow != 0 {
        negate(magnitude);
    }
    p.negative != (borrow != 0)
}

/// Adds `x * y`, or subtracts it, from the two's complement `sum`, modulo its length.
fn add_product(sum: &mut [u32], x: &[u32], y: &[u32], subtract: bool) {
    let step = if subtract { subtract_row } else { add_row };
    for (i, &factor) in x.iter().enumerate() {
        if factor != 0 && i < sum.len() {
            step(&mut sum[i..], factor, y);
        }
    }
}

/// `sum += factor * y`. The carry never exceeds one limb: `(2^32-1)^2 + 2 (2^32-1) = 2^64 - 1`.
fn add_row(sum: &mut [u32], factor: u32, y: &[u32]) {
    let mut carry = 0;
    for (k, limb) in sum.iter_mut().enumerate() {
        let (mut high, mut low) = (0, 0);
        if k < y.len() {
            (high, low) = umul_extended(factor, y[k]);
        } else if carry == 0 {
            return;
        }
        let (product, first) = uadd_carry(low, carry);
        let (total, second) = uadd_carry(*limb, product);
        (*limb, carry) = (total, high + first + second);
    }
}

/// `sum -= factor * y`. The borrow never exceeds one limb, as in `add_row`.
fn subtract_row(sum: &mut [u32], factor: u32, y: &[u32]) {
    let mut borrow = 0;
    for (k, limb) in sum.iter_mut().enumerate() {
        let (mut high, mut low) = (0, 0);
        if k < y.len() {
            (high, low) = umul_extended(factor, y[k]);
        } else if borrow == 0 {
            return;
        }
        let (product, first) = uadd_carry(low, borrow);
        let (total, second) = usub_borrow(*limb, product);
        (*limb, borrow) = (total, high + first + second);
    }
}

/// Two's complement negation.
fn negate(number: &mut [u32]) {
    let mut carry = 1;
    for limb in number {
        (*limb, carry) = uadd_carry(!*limb, carry);
    }
}

/// The sign of a two's complement number.
fn sign(number: &[u32]) -> Sign {
    match number.last() {
        Some(top) if top >> 31 == 1 => Sign::Negative,
        _ if number.iter().all(|&limb| limb == 0) => Sign::Zero,
        _ => Sign::Positive,
    }
}

/// High and low half of a product, as GLSL's `umulExtended`.
fn umul_extended(x: u32, y: u32) -> (u32, u32) {
    let product = u64::from(x) * u64::from(y);
    ((product >> 32) as u32, product as u32)
}

/// Sum and carry, as GLSL's `uaddCarry`.
fn uadd_carry(x: u32, y: u32) -> (u32, u32) {
    let (sum, carry) = x.overflowing_add(y);
    (sum, u32::from(carry))
}

/// Difference and borrow, as GLSL's `usubBorrow`.
fn usub_borrow(x: u32, y: u32) -> (u32, u32) {
    let (difference, borrow) = x.overflowing_sub(y);
    (difference, u32::from(borrow))
}
