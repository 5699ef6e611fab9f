//! Proper crossings by tests of all pairs of sub-constraints, in the order of (higher constraint, lower constraint): as soon as
//! there are enough, the rest need not be looked at.

use super::crossings::Parents;
use crate::Walk;
use glam::DVec2;
use polder_predicates::{Sign, orient2d};

/// The box around a sub-constraint.
struct Bounds {
    low: DVec2,
    high: DVec2,
}

impl Bounds {
    fn meets(&self, other: &Bounds) -> bool {
        !(self.low.cmpgt(other.high) | other.low.cmpgt(self.high)).any()
    }
}

/// Whether two sub-constraints cross at a point inside both. There is no vertex inside either.
fn cross(positions: &[DVec2], one: [u32; 2], other: [u32; 2]) -> bool {
    let divides = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| match orient2d(a, b, c) {
        Sign::Zero => false,
        side => orient2d(a, b, d) == -side,
    };
    if one.iter().any(|v| other.contains(v)) {
        return false;
    }
    let [one, other] = [one, other].map(|ends| ends.map(|v| positions[v as usize]));
    divides(one, other) && divides(other, one)
}

/// All crossings among the constraints up to the first by which there are more than `max`, or among all of them. None if that
/// takes more than `most` tests.
pub(super) fn pairwise(
    positions: &[DVec2],
    walk: &Walk,
    parents: &Parents,
    max: usize,
    most: u64,
) -> Option<Vec<[u32; 2]>> {
    let (mut pairs, mut tests) = (Vec::new(), 0u64);
    let (mut before, mut bounds_before) = (Vec::new(), Vec::new());
    let mut is_before = vec![false; walk.sub_constraints.len()];
    let ends = |s: u32| walk.sub_constraints[s as usize];
    let bounds = |s: u32| {
        let [a, b] = ends(s).map(|v| positions[v as usize]);
        Bounds { low: a.min(b), high: a.max(b) }
    };
    for j in 0..walk.chains.len() {
        for &s in walk.pieces(j) {
            tests += before.len() as u64;
            if tests > most {
                return None;
            }
            let own = bounds(s);
            for (&other, _) in before.iter().zip(&bounds_before).filter(|(_, other)| own.meets(other)) {
                if cross(positions, ends(s), ends(other)) {
                    pairs.extend(parents.of(other, j as u32).iter().map(|&i| [i, j as u32]));
                }
            }
        }
        if pairs.len() > max {
            break;
        }
        for &s in walk.pieces(j) {
            if !std::mem::replace(&mut is_before[s as usize], true) {
                before.push(s);
                bounds_before.push(bounds(s));
            }
        }
    }
    Some(pairs)
}
