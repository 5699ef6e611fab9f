//! The crossings inside one triangle.
//!
//! 1. Along each edge, the sub-constraints that run across it are sorted by where they do. Two that run across it at
//!    the same point cross there; the lower half-edge of the edge names them.
//! 2. Corners and points on edges are ranked round the boundary, equal points equal. A chord joins two ranks, and two
//!    chords cross in the interior if and only if their ranks alternate strictly.
//! 3. A sweep over the ranks keeps the open chords in the order in which they began. One that ends crosses those that
//!    began after it and are still open, and no others: the list is read from its end as far as that, so that every
//!    chord looked at is a crossing found.
//! 4. A sub-constraint that is an edge of the mesh crosses whatever runs across the edge.

use super::exact::{crossing_side, place as place_on};
use glam::DVec2;
use polder_predicates::{Sign, orient2d};
use std::cmp::Ordering;

/// How a sub-constraint meets a triangle: it goes in and out at 0, 1, 2, an edge, or 3, 4, 5, a corner; or it is one of
/// its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chord {
    /// The sub-constraint.
    pub(super) of: u32,
    /// `inward + 6 * outward`, or 36 plus an edge.
    code: u8,
}

const ALONG: u8 = 36;

impl Chord {
    pub(super) fn across(of: u32, inward: u8, outward: u8) -> Self {
        Self { of, code: inward + 6 * outward }
    }

    pub(super) fn along(of: u32, edge: u8) -> Self {
        Self { of, code: ALONG + edge }
    }

    fn edge(self) -> Option<u8> {
        self.code.checked_sub(ALONG)
    }

    fn ends(self) -> [u8; 2] {
        [self.code % 6, self.code / 6]
    }
}

/// A chord where it runs across an edge: about where, how far off that may be, and the line outward.
#[derive(Clone, Copy)]
struct Across {
    chord: u32,
    place: f64,
    error: f64,
    line: [DVec2; 2],
}

/// A triangle with the positions of its corners, and for each edge whether its half-edge here is the lower one.
pub(super) struct Place {
    pub(super) corners: [DVec2; 3],
    pub(super) lower: [bool; 3],
}

/// Room that is used again from triangle to triangle.
#[derive(Default)]
pub(super) struct Room {
    chords: Vec<Chord>,
    along: Vec<(u32, u8)>,
    sorted: Vec<Across>,
    ranks: Vec<[u32; 2]>,
    by_begin: Vec<u32>,
    by_end: Vec<u32>,
    before: Vec<u32>,
    after: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Room {
    /// Hands each pair of sub-constraints that cross in this triangle to `found`, until that answers false. `line` gives
    /// the positions of a sub-constraint's ends.
    pub(super) fn crossings(
        &mut self,
        place: &Place,
        chords: &[Chord],
        line: &impl Fn(u32) -> [DVec2; 2],
        found: &mut impl FnMut(u32, u32) -> bool,
    ) -> bool {
        self.chords.clear();
        self.along.clear();
        for &chord in chords {
            match chord.edge() {
                Some(edge) => self.along.push((chord.of, edge)),
                None => self.chords.push(chord),
            }
        }
        if self.chords.is_empty() || chords.len() < 2 {
            return true;
        }
        self.rank(place, line, found) && self.sweep(found)
    }

    /// Steps 1, 2 and 4.
    fn rank(
        &mut self,
        place: &Place,
        line: &impl Fn(u32) -> [DVec2; 2],
        found: &mut impl FnMut(u32, u32) -> bool,
    ) -> bool {
        self.ranks.clear();
        self.ranks.resize(self.chords.len(), [NONE; 2]);
        let set = |ranks: &mut [u32; 2], rank| {
            let i = usize::from(ranks[0] != NONE);
            ranks[i] = rank;
        };
        let mut rank = 0;
        for corner in 0..3u8 {
            for (chord, ranks) in self.chords.iter().zip(&mut self.ranks) {
                if chord.ends().contains(&(3 + corner)) {
                    set(ranks, rank);
                }
            }
            rank += 1;

            let edge = (corner + 2) % 3;
            let (u, v) = (place.corners[usize::from(corner)], place.corners[usize::from(corner + 1) % 3]);
            self.sorted.clear();
            for (i, chord) in self.chords.iter().enumerate() {
                let [inward, outward] = chord.ends();
                if inward == edge || outward == edge {
                    let [a, b] = line(chord.of);
                    let line = if outward == edge { [a, b] } else { [b, a] };
                    let (place, error) = place_on(u, v, line);
                    self.sorted.push(Across { chord: i as u32, place, error, line });
                }
            }
            for &(of, _) in self.along.iter().filter(|(_, k)| *k == edge) {
                if !self.sorted.iter().all(|i| found(of, self.chords[i.chord as usize].of)) {
                    return false;
                }
            }
            let order = |i: &Across, j: &Across| {
                let error = i.error + j.error;
                if i.place + error < j.place {
                    Ordering::Less
                } else if j.place + error < i.place {
                    Ordering::Greater
                } else {
                    order_along(u, v, i.line, j.line)
                }
            };
            self.sorted.sort_unstable_by(order);
            let mut from = 0;
            for to in 1..=self.sorted.len() {
                if to < self.sorted.len() && order(&self.sorted[to - 1], &self.sorted[to]) == Ordering::Equal {
                    continue;
                }
                let equal = &self.sorted[from..to];
                for (n, i) in equal.iter().enumerate() {
                    set(&mut self.ranks[i.chord as usize], rank);
                    let of = |i: &Across| self.chords[i.chord as usize].of;
                    let other = |j: &Across| found(of(i), of(j));
                    if place.lower[usize::from(edge)] && !equal[n + 1..].iter().all(other) {
                        return false;
                    }
                }
                rank += 1;
                from = to;
            }
        }
        true
    }

    /// Step 3.
    fn sweep(&mut self, found: &mut impl FnMut(u32, u32) -> bool) -> bool {
        let n = self.chords.len();
        let ranks = &self.ranks;
        for list in [&mut self.by_begin, &mut self.by_end] {
            list.clear();
            list.extend(0..n as u32);
        }
        self.by_begin.sort_unstable_by_key(|&i| (ranks[i as usize][0], i));
        // Of those that end together, the last to begin goes first.
        self.by_end.sort_unstable_by_key(|&i| (ranks[i as usize][1], std::cmp::Reverse(ranks[i as usize][0]), i));
        for links in [&mut self.before, &mut self.after] {
            links.clear();
            links.resize(n, NONE);
        }
        let mut last = NONE;
        let mut begun = 0;
        for &i in &self.by_end {
            let [begin, end] = ranks[i as usize];
            // Chords that begin where this one ends do not cross it.
            while begun < n && ranks[self.by_begin[begun] as usize][0] < end {
                let j = self.by_begin[begun];
                self.before[j as usize] = last;
                if last != NONE {
                    self.after[last as usize] = j;
                }
                last = j;
                begun += 1;
            }
            let (before, after) = (self.before[i as usize], self.after[i as usize]);
            if before != NONE {
                self.after[before as usize] = after;
            }
            if after == NONE {
                last = before
            } else {
                self.before[after as usize] = before
            }
            let mut j = last;
            while j != NONE && ranks[j as usize][0] > begin {
                if !found(self.chords[i as usize].of, self.chords[j as usize].of) {
                    return false;
                }
                j = self.before[j as usize];
            }
        }
        true
    }
}

/// The order of two lines along the edge from `u` to `v`, both of which leave across it to its right.
fn order_along(u: DVec2, v: DVec2, [a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Ordering {
    // An end that both share needs no test, and would need an exact one.
    let side = |a: DVec2, b: DVec2, c: DVec2| if c == a || c == b { Sign::Zero } else { orient2d(a, b, c) };
    let (of_c, of_d) = (side(a, b, c), side(a, b, d));
    if of_c != Sign::Negative && of_d != Sign::Negative {
        // The second one lies left of the first, that is towards v.
        return if of_c == of_d && of_c == Sign::Zero { Ordering::Equal } else { Ordering::Less };
    }
    if of_c != Sign::Positive && of_d != Sign::Positive {
        return Ordering::Greater;
    }
    let (of_a, of_b) = (side(c, d, a), side(c, d, b));
    if of_a != Sign::Negative && of_b != Sign::Negative {
        return Ordering::Greater;
    }
    if of_a != Sign::Positive && of_b != Sign::Positive {
        return Ordering::Less;
    }
    // They cross: before their crossing they are in the order of c and ab, after it in the other one.
    match (crossing_side(u, v, [a, b], [c, d]), of_c) {
        (Sign::Zero, _) => Ordering::Equal,
        (Sign::Negative, Sign::Positive) | (Sign::Positive, Sign::Negative) => Ordering::Less,
        _ => Ordering::Greater,
    }
}
