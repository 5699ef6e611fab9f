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
//! **orient2d.** The two products `l` and `r` are each off by at most `3.01 u |l| + 1.01 η` (two differences, one
//! product), and their difference by another `u |det|`. So the sign is right if
//! `|det| > 3.1 u (|l| + |r|) + 3 η`. The bound used, `4 u (|l| + |r|) + 2^-700`, is larger also after its own rounding.
//! If anything overflows, the bound is infinite or NaN, because rounding is monotonic, and the comparison fails.
//!
//! **incircle.** Write `A, B, C` for the exact differences to `d`, `L_a = |A|²` for the liftings,
//! `M_a = B_x C_y - C_x B_y` for the minors, `N_a = |B_x C_y| + |C_x B_y|`, and likewise for `b` and `c`. The exact
//! determinant is `E = Σ L M`; let `S = Σ L N` and `Q = L_a L_b + L_b L_c + L_c L_a`. Small letters are computed values.
//! Counting roundings:
//!
//! 1. `|m - M| ≤ ((1 + u)^4 - 1) N + 2.01 η` and `|l - L| ≤ ((1 + u)^4 - 1) L + 2.01 η`;
//! 2. a term `t` of the sum has `|t - L M| ≤ ((1 + u)^9 - 1) L N + 2.02 η (L + N) + 1.01 η`;
//! 3. after the two additions `|det - E| ≤ 11.01 u S + 2.03 η Σ (L + N) + 4 η`;
//! 4. `N_a ≤ |B| |C| ≤ (L_b + L_c) / 2`, so `S ≤ Q` and `Σ N ≤ Σ L`;
//! 5. with `P = l_a l_b + l_b l_c + l_c l_a` and `λ = l_a + l_b + l_c`, step 1 gives
//!    `Q ≤ (1 + 11 u)(P + 4.1 η λ + 13 η²)` and `Σ L ≤ (1 + 5 u)(λ + 6.1 η)`.
//!
//! Together `|det - E| ≤ 11.02 u P + 5 η λ + 5 η`. The bound used is `12 u q` with
//! `q = l_a (l_b + k) + (l_a + l_b + k)(l_c + k)`, which is `P + k (2 l_a + l_b + l_c) + k²`, for `k = 2^-300`. After its own
//! rounding it is at least `11.5 u (P + k λ + k²)`, which is larger, since `5 η` is far below `u k²`. And `k` is
//! so small that input with differences above `2^-140` loses nothing.
//!
//! If a difference, a lifting or a product of two differences overflows, then so does a lifting; if a minor overflows,
//! then so does a product of two liftings: the bound is infinite or NaN. The sum of the three `|t|` is at most
//! `(1 + 30 u) q`. So when a term or a partial sum overflows although `q` is finite, the rest of the sum is less than
//! `100 u` of it and cannot change its sign.
//!
//! The bound in Shewchuk1997 (references.bib) has `S` in the place of `Q`. It is sharper for needles along an axis, and it
//! costs a fifth of the time of the whole test.
//!
//! The proof needs IEEE 754 double arithmetic without fused or extended intermediate results. Rust promises that on
//! every target but 32-bit x86 without SSE2.

use crate::Sign;
use glam::DVec2;

/// 4 u for u = 2^-53.
const ORIENT: f64 = 2.0 * f64::EPSILON;
/// 12 u for u = 2^-53.
const INCIRCLE: f64 = 6.0 * f64::EPSILON;
/// 2^-700: covers whatever underflow can do in orient2d.
const ORIENT_UNDERFLOW: f64 = f64::from_bits((1023 - 700) << 52);
/// 2^-300: added to the liftings of the bound, covers whatever underflow can do in incircle.
const LIFTING_UNDERFLOW: f64 = f64::from_bits((1023 - 300) << 52);

#[inline(always)]
fn certain(value: f64, bound: f64) -> Option<Sign> {
    if value.abs() > bound { Some(if value > 0.0 { Sign::Positive } else { Sign::Negative }) } else { None }
}

/// The sign of the orientation of `abc`, if double precision suffices to know it.
#[inline(always)]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Option<Sign> {
    let left = (a.x - c.x) * (b.y - c.y);
    let right = (a.y - c.y) * (b.x - c.x);
    certain(left - right, ORIENT * (left.abs() + right.abs()) + ORIENT_UNDERFLOW)
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
    let (blift, clift) = (blift + LIFTING_UNDERFLOW, clift + LIFTING_UNDERFLOW);
    certain(value, INCIRCLE * (alift * blift + (alift + blift) * clift))
}
