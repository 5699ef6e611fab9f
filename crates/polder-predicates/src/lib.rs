//! Exact predicates with the canonical tie-break.
#![forbid(unsafe_code)]

use glam::DVec2;
use std::cmp::Ordering;

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
    fn of(x: f64) -> Self {
        if x > 0.0 {
            Self::Positive
        } else if x < 0.0 {
            Self::Negative
        } else {
            Self::Zero
        }
    }
}

impl std::ops::Neg for Sign {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }
}

fn coord(p: DVec2) -> robust::Coord<f64> {
    robust::Coord { x: p.x, y: p.y }
}

/// Positive if `c` lies to the left of the line from `a` to `b`: if `abc` is counterclockwise.
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    Sign::of(robust::orient2d(coord(a), coord(b), coord(c)))
}

/// Positive if `d` lies inside the circle through the counterclockwise `a`, `b`, `c`; zero if on it.
pub fn incircle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    Sign::of(robust::incircle(coord(a), coord(b), coord(c), coord(d)))
}

/// By x, then by y.
pub fn lexicographic(a: DVec2, b: DVec2) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// [`incircle`] with the canonical tie-break: never zero for four distinct points, `abc` counterclockwise.
pub fn incircle_canonical(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Sign {
    let sign = incircle(a, b, c, d);
    if sign != Sign::Zero {
        return sign;
    }
    // Lowering the smallest point's lifting: d itself falls below the plane through a, b, c; another one tilts that
    // plane, down at d unless d lies beyond the edge opposite to it.
    let smallest = [a, b, c, d].into_iter().min_by(|p, q| lexicographic(*p, *q));
    let opposite = match smallest {
        Some(p) if p == a => (b, c),
        Some(p) if p == b => (c, a),
        Some(p) if p == c => (a, b),
        _ => return Sign::Positive,
    };
    -orient2d(opposite.0, opposite.1, d)
}

/// Whether the edge `bc` shared by the counterclockwise triangles `abc` and `dcb` must be flipped to `ad`.
pub fn must_flip(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    match incircle(a, b, c, d) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => {
            let first = |p: DVec2, q: DVec2| if lexicographic(p, q).is_lt() { p } else { q };
            lexicographic(first(a, d), first(b, c)).is_lt()
        }
    }
}
