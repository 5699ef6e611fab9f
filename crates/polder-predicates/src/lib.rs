//! Exact predicates for points in the plane, with a canonical tie-break.
//!
//! - [`orient2d`] and [`incircle`] return the sign of the exact determinant, for every finite `f64`: huge, subnormal, or
//!   both in one call. -0.0 equals 0.0. With an infinite or NaN coordinate the answer is [`Sign::Zero`]; nothing panics.
//! - [`must_flip`] and [`incircle_canonical`] break ties of cocircular points so that the (constrained) Delaunay
//!   triangulation is unique; [`tiebreak`] has the proof. [`lexicographic`] is the order behind it.
//!
//! ```
//! use glam::dvec2;
//! use polder_predicates::{Sign, incircle, must_flip, orient2d};
//!
//! let (a, b, c) = (dvec2(0.1, 0.1), dvec2(0.2, 0.2), dvec2(0.3, 0.3));
//! // 0.3 is not three times 0.1 in binary, but all three points are on the line x = y.
//! assert_eq!(orient2d(a, b, c), Sign::Zero);
//!
//! let square = [dvec2(0.0, 0.0), dvec2(1e300, 0.0), dvec2(1e300, 1e300), dvec2(0.0, 1e300)];
//! assert_eq!(incircle(square[0], square[1], square[2], square[3]), Sign::Zero);
//! assert!(must_flip(square[0], square[1], square[3], square[2]));
//! ```
//!
//! # Paths
//!
//! A call takes the first of these that can decide. Each is a public module and can be called alone; a path that
//! cannot decide says `None`, and two that decide agree.
//!
//! 1. [`filter`]: plain `f64` with an error bound. It is inlined into the caller and decides nearly all calls on
//!    scattered points.
//! 2. [`integers`]: machine integers of 64, 128 and 256 bits for coordinates that are multiples of a common power of two
//!    not too far below them: lattices, and close calls between ordinary numbers.
//! 3. [`expansions`]: the adaptive predicates of the `robust` crate, inside the exponent range where they are exact.
//! 4. [`wide`]: `f64` mantissas with exponents that cannot run out, and an error bound again: points whose magnitudes
//!    have nothing in common, as long as they are not nearly on one line or circle.
//! 5. [`limbs`]: fixed-point numbers of `u32` limbs, which take whatever is left.
#![forbid(unsafe_code)]

use glam::DVec2;

pub mod expansions;
pub mod filter;
pub mod integers;
pub mod limbs;
pub mod tiebreak;
pub mod wide;

pub use tiebreak::{incircle_canonical, lexicographic, must_flip};

/// The sign of an exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    #[inline(always)]
    fn of<T: PartialOrd + Default>(value: T) -> Self {
        if value > T::default() {
            Self::Positive
        } else if value < T::default() {
            Self::Negative
        } else {
            Self::Zero
        }
    }
}

impl std::ops::Neg for Sign {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }
}

/// Positive if `c` lies to the left of the line from `a` to `b`, that is if `abc` is counterclockwise; zero if the
/// three points lie on one line.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, orient2d};
///
/// let (a, b) = (dvec2(0.0, 0.0), dvec2(3.0, 1.0));
/// assert_eq!(orient2d(a, b, dvec2(0.0, 1.0)), Sign::Positive);
/// assert_eq!(orient2d(a, b, dvec2(6.0, 2.0)), Sign::Zero);
/// assert_eq!(orient2d(a, b, dvec2(6.0, 2.0_f64.next_down())), Sign::Negative);
/// ```
#[inline]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    match filter::orient2d(a, b, c) {
        Some(sign) => sign,
        None => orient2d_exact(a, b, c),
    }
}

/// Positive if `d` lies inside the circle through the counterclockwise `a`, `b`, `c`; zero if on it.
///
/// Exchanging two of the four points changes the sign. If `a`, `b`, `c` lie on one line, the circle is that line and its
/// inside one of the two half planes.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, incircle};
///
/// let (a, b, c) = (dvec2(5.0, 0.0), dvec2(3.0, 4.0), dvec2(-4.0, 3.0));
/// assert_eq!(incircle(a, b, c, dvec2(0.0, 0.0)), Sign::Positive);
/// assert_eq!(incircle(a, b, c, dvec2(0.0, -5.0)), Sign::Zero);
/// assert_eq!(incircle(a, b, c, dvec2(1e-300, -5.0)), Sign::Negative);
/// ```
#[inline]
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    match filter::incircle(a, b, c, d) {
        Some(sign) => sign,
        None => incircle_exact(a, b, c, d),
    }
}

#[cold]
#[inline(never)]
fn orient2d_exact(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    integers::orient2d(a, b, c)
        .or_else(|| expansions::orient2d(a, b, c))
        .or_else(|| wide::orient2d(a, b, c))
        .unwrap_or_else(|| limbs::orient2d(a, b, c))
}

#[cold]
#[inline(never)]
fn incircle_exact(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    incircle_undecided(a, b, c, d)
}

/// What the filter leaves. Inlined into each caller's cold path, since on a lattice every call comes here.
#[inline(always)]
fn incircle_undecided(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    integers::incircle(a, b, c, d)
        .or_else(|| expansions::incircle(a, b, c, d))
        .or_else(|| wide::incircle(a, b, c, d))
        .unwrap_or_else(|| limbs::incircle(a, b, c, d))
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
