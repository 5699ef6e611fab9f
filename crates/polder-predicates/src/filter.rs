//! The floating-point filter: the fast path, which decides almost every call on scattered points.
//!
//! It evaluates the determinant in `f64` together with a bound on the error of that value. If the value is farther
//! from zero than the bound, its sign is the exact sign; otherwise the filter says nothing ([`None`]).
//!
//! # Why a sign it returns is right, for every input
//!
//! Let `u = 2^-53`, `η = 2^-1075` (half of the smallest subnormal). IEEE 754 arithmetic, rounding to nearest, gives as
//! long as nothing overflows
//!
//! - `fl(x ± y) = (x ± y)(1 + δ)`, `|δ| ≤ u`: sums have no underflow error at all;
//! - `fl(x y) = x y (1 + δ) + ε`, `|δ| ≤ u`, `|ε| ≤ η`.
//!
//! **Overflow.** All sums that make up the bound have terms of one sign, and every product in the value also stands, in
//! absolute value, in the bound. So if anything overflows, the bound is infinite or NaN, and `|value| > bound` is
//! false. A sum in the value cannot overflow while the bound stays finite, because rounding is monotonic:
//! `|fl(x - y)| ≤ fl(|x| + |y|)`.
//!
//! **orient2d.** The two products `l` and `r` are each off by at most `3.01 u |l| + 1.01 η` (two differences, one
//! product), and their difference by another `u |det|`. So the sign is right if
//! `|det| > 3.1 u (|l| + |r|) + 3 η`. The bound used, `4 u (|l| + |r|) + 2^-700`, is larger also after its own rounding.
//!
//! **incircle.** Write `A, B, C` for the exact differences to `d`, `L_a = |A|²` for the liftings,
//! `M_a = B_x C_y - C_x B_y` for the minors, `N_a = |B_x C_y| + |C_x B_y|`, and likewise for `b` and `c`. The exact
//! determinant is `E = Σ L M`, and let `S = Σ L N`. Counting roundings:
//!
//! 1. a computed minor `m` has `|m - M| ≤ ((1 + u)^4 - 1) N + 2.01 η`, a computed lifting `l` has
//!    `|l - L| ≤ ((1 + u)^4 - 1) L + 2.01 η`;
//! 2. a computed term has `|t - L M| ≤ ((1 + u)^9 - 1) L N + 2.02 η (L + N) + 1.01 η`;
//! 3. after the two additions `|det - E| ≤ 11.01 u S + 2.03 η Σ (L + N) + 4 η`;
//! 4. the computed permanent `p` goes the same way, so `S ≤ (1 + 12 u)(p + 2.03 η Σ (L + N) + 4 η)`;
//! 5. by `2 |x y| ≤ x² + y²`, `Σ N ≤ Σ L`, so `Σ (L + N) ≤ 2 Σ L ≤ 2.01 λ + 20 η` with `λ` the computed sum of
//!    liftings.
//!
//! Together `|det - E| ≤ 11.1 u p + 5 η λ + 5 η`. The bound used, `12 u p + 2^-700 (λ + 1)`, is larger also after its
//! own rounding (relative `4 u`, absolute `2 η`). Its second part is below the last place of the first unless some
//! differences are shorter than about `2^-150`, or differ that much in magnitude, so that ordinary input loses nothing.
//!
//! The proof needs IEEE 754 double arithmetic without fused or extended intermediate results. Rust promises that on
//! every target but 32-bit x86 without SSE2.

use crate::Sign;
use glam::DVec2;

/// 4 u for u = 2^-53.
const ORIENT: f64 = 2.0 * f64::EPSILON;
/// 12 u for u = 2^-53.
const INCIRCLE: f64 = 6.0 * f64::EPSILON;
/// 2^-700: covers whatever underflow can do.
const UNDERFLOW: f64 = f64::from_bits((1023 - 700) << 52);

#[inline(always)]
fn certain(value: f64, bound: f64) -> Option<Sign> {
    if value.abs() > bound { Some(if value > 0.0 { Sign::Positive } else { Sign::Negative }) } else { None }
}

/// The sign of the orientation of `abc`, if double precision suffices to know it.
#[inline(always)]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let left = (a.x - c.x) * (b.y - c.y);
    let right = (a.y - c.y) * (b.x - c.x);
    certain(left - right, ORIENT * (left.abs() + right.abs()) + UNDERFLOW)
}

/// The sign of the in-circle determinant, if double precision suffices to know it.
#[inline(always)]
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<Sign> {
    let (adx, ady) = (a.x - d.x, a.y - d.y);
    let (bdx, bdy) = (b.x - d.x, b.y - d.y);
    let (cdx, cdy) = (c.x - d.x, c.y - d.y);

    let (bxcy, cxby) = (bdx * cdy, cdx * bdy);
    let (cxay, axcy) = (cdx * ady, adx * cdy);
    let (axby, bxay) = (adx * bdy, bdx * ady);

    let alift = adx * adx + ady * ady;
    let blift = bdx * bdx + bdy * bdy;
    let clift = cdx * cdx + cdy * cdy;

    let value = alift * (bxcy - cxby) + blift * (cxay - axcy) + clift * (axby - bxay);
    let permanent =
        alift * (bxcy.abs() + cxby.abs()) + blift * (cxay.abs() + axcy.abs()) + clift * (axby.abs() + bxay.abs());
    let liftings = alift + blift + clift;
    certain(value, INCIRCLE * permanent + UNDERFLOW * (liftings + 1.0))
}
