//! On which side of a line two segments cross: the one predicate of this crate that is not an orientation test.
//!
//! With X the crossing of the lines `ab` and `cd`, o the orientation with respect to `cd` and e with respect to `uv`:
//! X = a + (b - a) o(a) / (o(a) - o(b)), so that
//!
//! ```text
//! e(X) = (e(b) o(a) - e(a) o(b)) / (o(a) - o(b)),
//! ```
//!
//! and the sign of the denominator is that of o(a), since a and b lie on different sides of `cd`. First in f64 with a
//! bound on the error; where that does not decide, in integers of any length.

use glam::DVec2;
use polder_predicates::Sign;
use std::cmp::Ordering;

/// The side of the line from `u` to `v` on which the segments `ab` and `cd` cross, which they do properly.
pub(super) fn crossing_side(u: DVec2, v: DVec2, [a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Sign {
    by_filter(u, v, [a, b], [c, d]).unwrap_or_else(|| by_integers(u, v, [a, b], [c, d]))
}

/// Half the distance from 1 to the next f64.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// Twice the area of a triangle, rounded, and a number at least as large as both of its products. None where the
/// products or their products could leave the range in which f64 rounds relatively.
fn area(a: DVec2, b: DVec2, c: DVec2) -> Option<(f64, f64)> {
    let fits = |x: f64| x == 0.0 || (1e-60..=1e60).contains(&x.abs());
    let (p, q) = (a - c, b - c);
    if ![p.x, p.y, q.x, q.y].into_iter().all(fits) {
        return None;
    }
    let (l, r) = (p.x * q.y, p.y * q.x);
    Some((l - r, l.abs() + r.abs()))
}

/// An area has an error below 4 ε times its size m: a difference, a product and a difference are rounded. So a product
/// of two has one below 10 ε m m', and the difference of two such below 12 ε times the sum; 24 is more than enough.
fn by_filter(u: DVec2, v: DVec2, [a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<Sign> {
    let ((oa, oa_size), (ob, ob_size)) = (area(c, d, a)?, area(c, d, b)?);
    let ((ea, ea_size), (eb, eb_size)) = (area(u, v, a)?, area(u, v, b)?);
    let value = eb * oa - ea * ob;
    if value.abs() <= 24.0 * EPSILON * (eb_size * oa_size + ea_size * ob_size) || oa.abs() <= 4.0 * EPSILON * oa_size {
        return None;
    }
    Some(if (value > 0.0) == (oa > 0.0) { Sign::Positive } else { Sign::Negative })
}

/// Where the line through `a` and `b` meets the segment from `u` to `v`, whose ends lie on different sides of it: between
/// 0 at `u` and 1 at `v`, with a bound on the error, which may be infinite.
///
/// With areas of n and m at the ends the place is n / (n + m). Errors of at most e and f in them change it by at most
/// (e + f) / (n + m - e - f); another 8 ε are for the sum and the quotient, and all is doubled.
pub(super) fn place(u: DVec2, v: DVec2, [a, b]: [DVec2; 2]) -> (f64, f64) {
    let (Some((n, n_size)), Some((m, m_size))) = (area(a, b, u), area(a, b, v)) else { return (0.5, f64::INFINITY) };
    let (n, m, error) = (n.abs(), m.abs(), 4.0 * EPSILON * (n_size + m_size));
    if n + m <= 4.0 * error {
        return (0.5, f64::INFINITY);
    }
    (n / (n + m), 2.0 * (error / (n + m - error) + 8.0 * EPSILON))
}

fn by_integers(u: DVec2, v: DVec2, [a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Sign {
    let all = [u, v, a, b, c, d];
    let low = all.iter().flat_map(|p| [p.x, p.y]).filter(|&x| x != 0.0).map(|x| parts(x).2).min().unwrap_or(0);
    let orient = |p: DVec2, q: DVec2, r: DVec2| {
        let [px, py, qx, qy, rx, ry] = [p.x, p.y, q.x, q.y, r.x, r.y].map(|x| Integer::of(x, low));
        let (first, second) = (px.minus(&rx).times(&qy.minus(&ry)), py.minus(&ry).times(&qx.minus(&rx)));
        first.minus(&second)
    };
    let (oa, ob, ea, eb) = (orient(c, d, a), orient(c, d, b), orient(u, v, a), orient(u, v, b));
    let (value, denominator) = (eb.times(&oa).minus(&ea.times(&ob)).sign(), oa.sign());
    if denominator == Sign::Negative { -value } else { value }
}

/// A finite number as sign, integer and power of two.
pub(super) fn parts(x: f64) -> (bool, u64, i32) {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let integer = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    (bits >> 63 == 1, integer, exponent.max(1) - 1075)
}

/// An integer of any length: limbs of 32 bits, the lowest first, none of them zero at the end.
#[derive(Clone, Debug)]
pub(super) struct Integer {
    pub(super) negative: bool,
    pub(super) limbs: Vec<u32>,
}

impl Integer {
    /// `x` divided by two to the power `low`, which is no more than the exponent of `x`.
    pub(super) fn of(x: f64, low: i32) -> Self {
        let (negative, integer, exponent) = parts(x);
        if integer == 0 {
            return Self { negative: false, limbs: Vec::new() };
        }
        let shift = (exponent - low) as usize;
        let mut limbs = vec![0; shift / 32];
        let mut rest = u128::from(integer) << (shift % 32);
        while rest > 0 {
            limbs.push(rest as u32);
            rest >>= 32;
        }
        Self { negative, limbs }
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut limbs = vec![0u32; self.limbs.len() + other.limbs.len()];
        for (i, &x) in self.limbs.iter().enumerate() {
            let mut carry = 0u64;
            for (j, &y) in other.limbs.iter().enumerate() {
                let sum = u64::from(x) * u64::from(y) + u64::from(limbs[i + j]) + carry;
                limbs[i + j] = sum as u32;
                carry = sum >> 32;
            }
            limbs[i + other.limbs.len()] = carry as u32;
        }
        Self { negative: self.negative != other.negative, limbs }.trimmed()
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        if self.negative != other.negative {
            return Self { negative: self.negative, limbs: sum(&self.limbs, &other.limbs) }.trimmed();
        }
        match compare(&self.limbs, &other.limbs) {
            Ordering::Less => Self { negative: !self.negative, limbs: difference(&other.limbs, &self.limbs) }.trimmed(),
            _ => Self { negative: self.negative, limbs: difference(&self.limbs, &other.limbs) }.trimmed(),
        }
    }

    fn trimmed(mut self) -> Self {
        while self.limbs.last() == Some(&0) {
            self.limbs.pop();
        }
        self.negative &= !self.limbs.is_empty();
        self
    }

    pub(super) fn sign(&self) -> Sign {
        match (self.limbs.is_empty(), self.negative) {
            (true, _) => Sign::Zero,
            (false, true) => Sign::Negative,
            (false, false) => Sign::Positive,
        }
    }
}

pub(super) fn compare(a: &[u32], b: &[u32]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

fn sum(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut carry = 0u64;
    let limb = |x: &[u32], i: usize| u64::from(x.get(i).copied().unwrap_or(0));
    (0..=a.len().max(b.len()))
        .map(|i| {
            carry += limb(a, i) + limb(b, i);
            let out = carry as u32;
            carry >>= 32;
            out
        })
        .collect()
}

/// `a` is not less than `b`.
pub(super) fn difference(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut borrow = 0i64;
    a.iter()
        .enumerate()
        .map(|(i, &x)| {
            borrow += i64::from(x) - i64::from(b.get(i).copied().unwrap_or(0));
            let out = borrow as u32;
            borrow >>= 32;
            out
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use polder_predicates::orient2d;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn knows_a_crossing_on_the_line_from_one_beside_it() {
        for scale in [1.0, 1e-300, 1e150, 1e300] {
            let q = |x: f64, y: f64| p(x * scale, y * scale);
            let (s, t) = ([q(-1.0, -1.0), q(3.0, 3.0)], [q(-2.0, 2.0), q(1.0, -1.0)]);
            assert_eq!(crossing_side(q(0.0, -5.0), q(0.0, 5.0), s, t), Sign::Zero, "{scale}");
            assert_eq!(crossing_side(q(0.5, -5.0), q(0.0, 5.0), s, t), Sign::Positive, "{scale}");
            assert_eq!(crossing_side(q(0.0, -5.0), q(-0.5, 5.0), t, s), Sign::Negative, "{scale}");
        }
    }

    #[test]
    fn both_ways_agree() {
        let mut random = 1u32;
        let mut next = || {
            random = polder_flip::priority(random.wrapping_add(77));
            f64::from(random % 9) - 3.0
        };
        let mut decided = [0; 3];
        while decided.iter().sum::<i32>() < 20_000 {
            let [u, v, a, b, c, d] = [(); 6].map(|()| p(next(), next()));
            let crosses = |a, b, c, d| orient2d(a, b, c) == -orient2d(a, b, d) && orient2d(a, b, c) != Sign::Zero;
            if u == v || !crosses(a, b, c, d) || !crosses(c, d, a, b) {
                continue;
            }
            let exact = by_integers(u, v, [a, b], [c, d]);
            decided[(exact as i8 + 1) as usize] += 1;
            match by_filter(u, v, [a, b], [c, d]) {
                Some(sign) => assert_eq!(sign, exact),
                None => assert_eq!(exact, Sign::Zero, "small integers leave the filter in doubt only at zero"),
            }
            // The crossing does not depend on how its segments are named.
            assert_eq!(by_integers(u, v, [d, c], [a, b]), exact);
            assert_eq!(by_integers(v, u, [b, a], [c, d]), -exact);
        }
        assert!(decided.iter().all(|&n| n > 100), "{decided:?}");
    }
}
