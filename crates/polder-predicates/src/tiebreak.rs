//! The canonical tie-break: one triangulation for each input, also where points are cocircular.
//!
//! Where four points lie exactly on one circle, either diagonal of their quadrilateral is Delaunay. The rule here: the
//! diagonal that touches the lexicographically smallest of the four (by x, then by y) is the one that stays. Below is
//! why this local rule, applied edge by edge, has one outcome for the whole triangulation.
//!
//! Lawson's flips (Lawson1977 in references.bib) on a lifting that is perturbed symbolically (as in
//! EdelsbrunnerMuecke1990).
//!
//! # Setting
//!
//! `V` is a finite set of distinct points, not all on one line, and `S` a set of segments between them that meet only at
//! common ends and contain no other point of `V` (constraints cut at the vertices on them). A *triangulation* here
//! covers the convex hull of `V`, uses every point of `V`, and contains `S`. A *flip* replaces an edge `bc` that is not
//! in `S`, between triangles `abc` and `dcb` (both counterclockwise), by `ad`; [`must_flip`] says when.
//!
//! # The rule is a perturbed lifting
//!
//! Lift each point `p` to the height `z(p) = |p|² - ε(p)`. Sort `V` lexicographically and let `ε(p) = t^k` for the
//! `k`-th point, `k = 1, 2, ...`: the smallest point is lowered most, each next one by less by the factor `t > 0`.
//! For `abc` counterclockwise, `d` is below the plane through `a`, `b`, `c` after lifting iff the determinant
//!
//! ```text
//! D(a, b, c, d) = z(a) [bcd] + z(b) [cad] + z(c) [abd] - z(d) [abc]
//! ```
//!
//! is positive, with `[pqr]` the orientation determinant. For `z(p) = |p|²` it is the in-circle determinant. So
//!
//! ```text
//! D = incircle(a, b, c, d) - ε(a) [bcd] - ε(b) [cad] - ε(c) [abd] + ε(d) [abc].
//! ```
//!
//! There are finitely many quadruples in `V`, so some `t` is small enough for all at once:
//!
//! - if `incircle` is not zero, `D` has its sign;
//! - if it is zero and the four points are distinct and not on one line, then they lie on a circle, no three of them on
//!   a line, no bracket is zero, and the term of the smallest point, whose `ε` dominates, gives the sign of `D`.
//!
//! So `D` is never zero for a triangle `abc` and a fourth point `d`, and its sign is [`incircle_canonical`]. For a
//! convex quadrilateral with the corners `a, b, d, c` in counterclockwise order, `[bcd] < 0`, `[cad] > 0`, `[abd] > 0`,
//! `[abc] > 0`: in a tie, `D > 0` iff the smallest point is `a` or `d`, which is the rule of [`must_flip`]. Both are
//! the same rule, and it depends on nothing but the four points.
//!
//! # Every flip is possible
//!
//! If `must_flip(a, b, c, d)`, then `d` is inside the circle through `a`, `b`, `c` or on it, beyond `bc`. The parts
//! of the disk beyond its chords `ab`, `bc` and `ca` are disjoint and the chords meet only in corners, so `d` is
//! strictly on the inner side of the lines `ab` and `ca`: the quadrilateral is strictly convex, and `ad` can replace
//! `bc` with two triangles that are strictly counterclockwise.
//!
//! # Flips end
//!
//! Over the quadrilateral, the lifted triangles before and after the flip are the upper and the lower side of a
//! tetrahedron, which is not flat since `D` is not zero. So each flip lowers the piecewise linear surface over the hull,
//! strictly somewhere and nowhere the opposite. No triangulation comes back, and there are finitely many. This holds
//! for any start, any order of flips, and flips done at the same time in disjoint quadrilaterals.
//!
//! # One end
//!
//! Let `T` be a triangulation in which no edge outside `S` must be flipped: across each such edge the surface bends
//! upward, strictly. For a triangle `t` of `T` let `h_t` be the plane through its lifted corners.
//!
//! *Claim.* If a vertex `v` is visible from a point `x` inside `t` (the segment `xv` crosses no segment of `S`), then
//! `z(v) > h_t(v)` unless `v` is a corner of `t`. Indeed, for all `x` in general position near such a point, `xv` meets
//! no vertex but `v`. It runs through triangles `t = t_0, t_1, ..., t_k`, the last with the corner `v`, and crosses the
//! edges between them from one side to the other. No crossed edge is in `S`, so `h_{t_{i+1}} > h_{t_i}` strictly beyond
//! the edge, where `v` lies. Hence `z(v) = h_{t_k}(v) > ... > h_{t_0}(v)`.
//!
//! Let `T` and `T'` both be ends, and `x` a point in general position inside `t` of `T` and `t'` of `T'`. No segment of
//! `S` runs through the inside of `t'`, so the corners of `t'` are visible from `x`, and by the claim none of them is
//! below `h_t`. The surface of `T'` at `x` is a weighted mean of them with positive weights, so it is at least
//! `h_t(x)`, the surface of `T`, and equal only if all three corners are corners of `t`. Exchanging the roles gives the
//! opposite inequality. So they are equal, `t = t'`, and therefore `T = T'`.
//!
//! The end exists, is unique, and is reached by every sequence of flips from every start. It is the constrained
//! Delaunay triangulation of `V` and `S` for the lifting `z`, and therefore one for the true lifting as well.

use crate::{Sign, filter, incircle_undecided, orient2d};
use glam::DVec2;
use std::cmp::Ordering;

/// By x, then by y, with -0.0 equal to 0.0.
///
/// A total order on all inputs: NaN comes last, or first if its sign bit is set.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::lexicographic;
/// use std::cmp::Ordering;
///
/// assert_eq!(lexicographic(dvec2(0.0, 5.0), dvec2(1.0, 2.0)), Ordering::Less);
/// assert_eq!(lexicographic(dvec2(0.0, 5.0), dvec2(-0.0, 2.0)), Ordering::Greater);
/// assert_eq!(lexicographic(dvec2(0.0, -0.0), dvec2(-0.0, 0.0)), Ordering::Equal);
/// ```
#[inline]
pub fn lexicographic(a: DVec2, b: DVec2) -> Ordering {
    // Adding 0.0 turns -0.0 into 0.0 and changes nothing else.
    (a.x + 0.0).total_cmp(&(b.x + 0.0)).then_with(|| (a.y + 0.0).total_cmp(&(b.y + 0.0)))
}

/// [`incircle`](crate::incircle) with the canonical tie-break: the sign for the perturbed lifting of the [module's docs](self).
///
/// For `abc` counterclockwise, positive if `d` lies inside the circle, or on it in the sense of the tie-break. Zero only
/// if two of the points are equal or all four lie on one line. Exchanging two points changes the sign.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::{Sign, incircle, incircle_canonical};
///
/// let [a, b, c, d] = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
/// assert_eq!(incircle(a, b, c, d), Sign::Zero);
/// // The diagonal ac touches the smallest point and stays; bd does not.
/// assert_eq!(incircle_canonical(a, b, c, d), Sign::Negative);
/// assert_eq!(incircle_canonical(b, c, d, a), Sign::Positive);
/// ```
#[inline]
pub fn incircle_canonical(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    match filter::incircle(a, b, c, d) {
        Some(sign) => sign,
        None => incircle_canonical_exact(a, b, c, d),
    }
}

#[cold]
#[inline(never)]
fn incircle_canonical_exact(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    let sign = incircle_undecided(a, b, c, d);
    if sign != Sign::Zero {
        return sign;
    }
    if a == b || a == c || a == d || b == c || b == d || c == d {
        return Sign::Zero;
    }
    let smaller = |p: DVec2, q: DVec2| if lexicographic(p, q).is_lt() { p } else { q };
    let smallest = smaller(smaller(a, b), smaller(c, d));
    if smallest == a {
        -orient2d(b, c, d)
    } else if smallest == b {
        -orient2d(c, a, d)
    } else if smallest == c {
        -orient2d(a, b, d)
    } else {
        orient2d(a, b, c)
    }
}

/// Whether the edge `bc` shared by the counterclockwise triangles `abc` and `dcb` must be flipped to `ad`.
///
/// The same as whether [`incircle_canonical`] is positive, cheaper in a tie. If it holds, the quadrilateral is strictly
/// convex. Exchanging the two triangles (`must_flip(d, c, b, a)`) does not change the answer.
///
/// ```
/// use glam::dvec2;
/// use polder_predicates::must_flip;
///
/// let [a, b, c, d] = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0)];
/// assert!(must_flip(a, b, c, d)); // to ad, which touches a, the smallest of the four
/// assert!(!must_flip(b, d, a, c));
/// ```
#[inline]
pub fn must_flip(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    match filter::incircle(a, b, c, d) {
        Some(sign) => sign == Sign::Positive,
        None => must_flip_exact(a, b, c, d),
    }
}

#[cold]
#[inline(never)]
fn must_flip_exact(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    match incircle_undecided(a, b, c, d) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => {
            let smaller = |p: DVec2, q: DVec2| if lexicographic(p, q).is_lt() { p } else { q };
            lexicographic(smaller(a, d), smaller(b, c)).is_lt()
        }
    }
}
