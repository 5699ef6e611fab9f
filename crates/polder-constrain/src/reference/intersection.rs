//! Where two segments cross, correctly rounded.
//!
//! With o the orientation with respect to the line `cd`, the crossing of `ab` and `cd` is
//!
//! ```text
//! X = (b o(a) - a o(b)) / (o(a) - o(b)),
//! ```
//!
//! in each coordinate a quotient of integers times a power of two. The quotient is found bit by bit, ten bits more than a
//! number holds, and rounded once, to even where it lies in the middle.

use super::exact::{Integer, compare, difference, parts};
use glam::DVec2;
use polder_predicates::Sign;
use std::cmp::Ordering;

/// The point at which the segments `ab` and `cd` cross, each coordinate rounded to the nearest number; None if their lines
/// are parallel. Where only the lines cross it is that of the lines, which may be infinitely far.
///
/// The result does not depend on the order or the direction of the segments, and zero is never negative. Rounding keeps
/// order, so crossings along one segment come, rounded, in the order in which they lie there, or fall together, and none
/// leaves the box of its segments.
pub fn intersection([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<DVec2> {
    let all = [a, b, c, d];
    let low = all.iter().flat_map(|p| [p.x, p.y]).filter(|&x| x != 0.0).map(|x| parts(x).2).min().unwrap_or(0);
    let of = |p: DVec2| [p.x, p.y].map(|x| Integer::of(x, low));
    let [a, b, c, d] = [of(a), of(b), of(c), of(d)];
    let side = |p: &[Integer; 2]| {
        let first = d[0].minus(&c[0]).times(&p[1].minus(&c[1]));
        first.minus(&d[1].minus(&c[1]).times(&p[0].minus(&c[0])))
    };
    let (from, to) = (side(&a), side(&b));
    let denominator = from.minus(&to);
    if denominator.sign() == Sign::Zero {
        return None;
    }
    let coordinate = |k: usize| rounded(&b[k].times(&from).minus(&a[k].times(&to)), &denominator, low);
    Some(DVec2::new(coordinate(0), coordinate(1)))
}

/// `n / d * 2^low`, rounded; `d` is not zero.
fn rounded(n: &Integer, d: &Integer, low: i32) -> f64 {
    if n.limbs.is_empty() {
        return 0.0;
    }
    // The quotient of the lengths in bits, shifted so that 64 or 65 bits stand before the point.
    let shift = 64 + bits(&d.limbs) - bits(&n.limbs);
    let mut rest = shifted(&n.limbs, shift.max(0));
    let mut part = shifted(&d.limbs, (-shift).max(0) + 66);
    let mut quotient = 0u128;
    for _ in 0..=66 {
        quotient <<= 1;
        if compare(&rest, &part) != Ordering::Less {
            rest = trimmed(difference(&rest, &part));
            quotient |= 1;
        }
        halve(&mut part);
    }
    let length = 128 - quotient.leading_zeros() as i32;
    // What the first bit is worth, and how many bits a number of that size has; less than one if it is very small.
    let exponent = length - 1 + low - shift;
    let precision = if exponent >= -1022 { 53 } else { 53 + 1022 + exponent };
    if precision < 0 {
        return 0.0;
    }
    if exponent > 1023 {
        // The lines cross far away from the segments.
        return if n.negative == d.negative { f64::INFINITY } else { f64::NEG_INFINITY };
    }
    let dropped = (length - precision) as u32;
    let mut kept = (quotient >> dropped) as u64;
    let (below, half) = (quotient & ((1 << dropped) - 1), 1u128 << (dropped - 1));
    let is_more = below > half || below == half && (!rest.is_empty() || kept & 1 == 1);
    kept += u64::from(is_more);
    let unit = exponent - precision + 1;
    let unit =
        if unit >= -1022 { f64::from_bits(((unit + 1023) as u64) << 52) } else { f64::from_bits(1 << (unit + 1074)) };
    let size = kept as f64 * unit;
    if n.negative == d.negative || size == 0.0 { size } else { -size }
}

fn bits(limbs: &[u32]) -> i32 {
    32 * limbs.len() as i32 - limbs.last().map_or(0, |limb| limb.leading_zeros() as i32)
}

fn shifted(limbs: &[u32], by: i32) -> Vec<u32> {
    let (words, bits) = (by as usize / 32, by as u32 % 32);
    let mut out = vec![0; words];
    let mut carry = 0u64;
    for &limb in limbs {
        carry |= u64::from(limb) << bits;
        out.push(carry as u32);
        carry >>= 32;
    }
    out.push(carry as u32);
    trimmed(out)
}

fn halve(limbs: &mut Vec<u32>) {
    let mut carry = 0;
    for limb in limbs.iter_mut().rev() {
        let next = *limb << 31;
        *limb = *limb >> 1 | carry;
        carry = next;
    }
    if limbs.last() == Some(&0) {
        limbs.pop();
    }
}

fn trimmed(mut limbs: Vec<u32>) -> Vec<u32> {
    while limbs.last() == Some(&0) {
        limbs.pop();
    }
    limbs
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use dashu::rational::RBig;

    struct Random(u32);

    impl Random {
        fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_add(0x9e37_79b9);
            polder_flip::priority(self.0)
        }

        fn number(&mut self, kind: u32) -> f64 {
            let unit = f64::from(self.next()) / 2f64.powi(31) - 1.0;
            let sign = if self.next().is_multiple_of(2) { 1.0 } else { -1.0 };
            match kind {
                0 => f64::from(self.next() % 11) - 5.0,
                1 => unit + f64::from(self.next()) * 2f64.powi(-60),
                2 => 1e300 * unit,
                3 => sign * f64::from_bits(u64::from(self.next() % 40)),
                4 => unit * 2f64.powi(-1040) + f64::from_bits(1),
                5 => 1.0 + f64::from(self.next() % 5) * f64::EPSILON,
                _ => unit * 2f64.powi((self.next() % 2000) as i32 - 1000),
            }
        }

        fn point(&mut self, kind: u32) -> DVec2 {
            DVec2::new(self.number(kind), self.number(kind))
        }
    }

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Whether no number is nearer to the quotient, and no even one as near if this is odd.
    fn is_nearest(x: f64, value: &RBig) -> bool {
        let distance = |y: f64| (exact(y) - value.clone()).max(value.clone() - exact(y));
        let ours = distance(x);
        [x.next_up(), x.next_down()].into_iter().filter(|y| y.is_finite()).all(|y| {
            let other = distance(y);
            ours < other || ours == other && x.to_bits().is_multiple_of(2)
        })
    }

    #[test]
    fn no_number_is_nearer() {
        let mut random = Random(1);
        let (mut crossings, mut ties) = (0, 0);
        for round in 0..16_000 {
            let kind = round % 8;
            let [a, b, c, d] = [(); 4].map(|()| random.point(kind));
            let [[ax, ay], [bx, by], [cx, cy], [dx, dy]] = [a, b, c, d].map(|p| [exact(p.x), exact(p.y)]);
            let side = |x: &RBig, y: &RBig| (&dx - &cx) * (y - &cy) - (&dy - &cy) * (x - &cx);
            let (from, to) = (side(&ax, &ay), side(&bx, &by));
            let below = &from - &to;
            let found = intersection([a, b], [c, d]);
            if below == RBig::ZERO {
                assert_eq!(found, None);
                continue;
            }
            // Lines may cross far from the segments; where the segments do, nothing overflows.
            if (from > RBig::ZERO) == (to > RBig::ZERO) {
                continue;
            }
            let point = found.unwrap();
            let x = (&bx * &from - &ax * &to) / &below;
            let y = (&by * &from - &ay * &to) / &below;
            if point.is_finite() {
                assert!(is_nearest(point.x, &x) && is_nearest(point.y, &y), "{a} {b} {c} {d}: {point}");
                ties += u32::from(exact(point.x) == x);
                crossings += 1;
            }
            assert_eq!(intersection([d, c], [a, b]), found);
            assert_eq!(intersection([b, a], [c, d]), found);
            assert!(point.x.to_bits() != (-0.0f64).to_bits() && point.y.to_bits() != (-0.0f64).to_bits());
        }
        assert!(crossings > 4000 && ties > 250, "{crossings} {ties}");
    }

    #[test]
    fn parallel_lines_have_none() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        assert_eq!(intersection([p(0.0, 0.0), p(2.0, 2.0)], [p(1.0, 0.0), p(3.0, 2.0)]), None);
        assert_eq!(intersection([p(0.0, 0.0), p(0.0, 0.0)], [p(0.0, 0.0), p(0.0, 0.0)]), None);
        assert_eq!(intersection([p(-1.0, -1.0), p(1.0, 1.0)], [p(-1.0, 1.0), p(1.0, -1.0)]), Some(DVec2::ZERO));
        let m = f64::MAX;
        assert_eq!(intersection([p(-m, -m), p(m, m)], [p(-m, m), p(m, -m)]), Some(DVec2::ZERO));
        assert_eq!(intersection([p(m, -m), p(m, m)], [p(-m, m), p(m, m)]), Some(p(m, m)));
    }
}
