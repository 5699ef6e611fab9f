//! Pairs of triangles with the same owner are flipped. \[QCT\] section 4, algorithm 5: the inner loop.
//!
//! For a triangle A of a chain, B is the one before it and C the one after it, seen from the lower end of the owner. An
//! *inner round*:
//!
//! 1. The configuration of (A, C) is found for each listed triangle A whose next one has the same owner, if that goes by flips.
//! 2. (A, C) is flippable
//!    - in case 1, if it is a zero or single intersection;
//!    - in case 2, if it and (B, A) are double ones, and B and what would then come after it were a single one;
//!    - in case 3, if it is a double one, (B, A) is concave, and B and what would then come after it were not.
//!
//!    A flippable pair claims A and C, in cases 2 and 3 also B, for the lowest case and, of the same case, the least
//!    priority of A.
//! 3. Pairs that got all they claimed are flipped. The sides of the corners stay known, so that no test is needed to see
//!    which of the new triangles the owner crosses; the others are nobody's from then on.
//! 4. Listed for the next round are the triangles of flips and their neighbors, and the A of pairs that were not flipped.
//!    (The first list has the triangles that got their owner in the outer round, and their neighbors.)
//!
//! Departure from the paper: there all owned triangles are looked at in every round. But whether (A, C) is flippable
//! depends on A, B and C alone, so that a pair that was not need not be looked at until one of the three has changed.
//!
//! What decides about a flip lies within its claimed triangles. So flips of one round may be thought of as made one after
//! the other, and each makes (length, number) of its chain smaller: see
//! [`TriangleChain::measure`](super::TriangleChain::measure).

use super::configuration::Configuration;
use super::insert::Insertion;
use super::pairs::{Candidate, Owned, words_of_flip};
use super::place::{self, FREE};
use crate::ConstrainError;
use polder_mesh::{NONE, twin_code};

/// Rules other than the stage's own.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Trial {
    /// Every double intersection is flippable in case 1, without a look at what lies before it.
    pub blind: bool,
    /// One flip a round at most.
    pub single_file: bool,
}

#[derive(Debug)]
pub(super) struct Inner {
    /// For each triangle A the configuration of (A, C), if it has one in this round.
    configurations: Vec<Option<Configuration>>,
    /// For each triangle the least claim, the highest number between rounds.
    claims: Vec<u32>,
    candidates: Vec<Candidate>,
    /// Pairs that might have been flipped before the walks of this outer round, and their claims.
    held: Vec<(u32, [u32; 3])>,
    /// The triangles A to look at in the next round, and whether a triangle is one of them.
    work: Vec<u32>,
    listed: Vec<bool>,
    pub(super) trial: Trial,
}

const UNCLAIMED: u32 = u32::MAX;

impl Inner {
    pub(super) fn new(slots: usize) -> Self {
        Self {
            configurations: vec![None; slots],
            claims: vec![UNCLAIMED; slots],
            candidates: Vec::new(),
            held: Vec::new(),
            work: Vec::new(),
            listed: vec![false; slots],
            trial: Trial::default(),
        }
    }
}

impl Insertion<'_> {
    /// One inner round; gives the number of pairs that won. One without any does not count.
    ///
    /// # Errors
    ///
    /// [`ConstrainError::Blocked`] names the lowest sub-constraint that would have flipped a constrained edge away. What crosses
    /// a sub-constraint can become an edge by that one's own flips, without which none of the two need walk across the other.
    pub fn inner_round(&mut self) -> Result<u64, ConstrainError> {
        let mut work = std::mem::take(&mut self.inner.work);
        for &t in &work {
            self.inner.listed[t as usize] = false;
        }
        // Step 1.
        work.retain(|&t| self.is_by_flips(t));
        for &t in &work {
            self.inner.configurations[t as usize] = self.owned().next_pair(t as usize).map(|(_, c)| c);
        }
        // Step 2.
        let mut candidates = std::mem::take(&mut self.inner.candidates);
        candidates.clear();
        for &t in &work {
            let Some(candidate) = self.candidate(t as usize) else { continue };
            for triangle in self.claimed(candidate) {
                let claim = &mut self.inner.claims[triangle as usize];
                *claim = (*claim).min(candidate.key());
            }
            candidates.push(candidate);
        }
        for (key, triangles) in &self.inner.held {
            for &t in triangles.iter().filter(|&&t| t != NONE) {
                let claim = &mut self.inner.claims[t as usize];
                *claim = (*claim).min(*key);
            }
        }
        // Step 3. Whether a candidate wins is settled by the claims, which flips do not touch.
        let wins = |c: &Candidate| self.claimed(*c).all(|t| self.inner.claims[t as usize] == c.key());
        let mut winners: Vec<Candidate> = candidates.iter().copied().filter(wins).collect();
        if self.inner.trial.single_file {
            winners.sort_unstable_by_key(Candidate::key);
            winners.truncate(1);
        }
        for &candidate in &candidates {
            for t in self.claimed(candidate) {
                self.inner.claims[t as usize] = UNCLAIMED;
            }
        }
        for t in std::mem::take(&mut self.inner.held).into_iter().flat_map(|(_, t)| t).filter(|&t| t != NONE) {
            self.inner.claims[t as usize] = UNCLAIMED;
        }
        // Step 4.
        work.clear();
        self.inner.work = work;
        for &candidate in &candidates {
            self.list(candidate.h / 3);
        }
        self.inner.candidates = candidates;
        let won = winners.len() as u64;
        self.report.inner_rounds += u64::from(won > 0);
        let (blocked, flipped): (Vec<_>, Vec<_>) = winners.into_iter().partition(|w| self.mesh.is_constrained(w.h));
        for winner in &flipped {
            self.flip(winner.h);
            self.report.flips[usize::from(winner.case - 1)] += 1;
        }
        let lowest = blocked.iter().filter_map(|w| Some((place::owner(self.owner[(w.h / 3) as usize])?, w.h))).min();
        lowest.map_or(Ok(won), |(s, h)| Err(self.blocked(s, h)))
    }

    /// The pairs that may be flipped now claim their triangles, whoever owns these after the walks.
    pub(super) fn hold_pairs(&mut self) {
        let held = self.inner.work.iter().filter(|&&a| self.is_by_flips(a)).filter_map(|&a| {
            let (_, own) = self.owned().next_pair(a as usize)?;
            let before = |b: u32| self.owned().next_pair(b as usize).map(|(_, c)| c);
            let pair = self.owned().candidate(a as usize, own, before, self.inner.trial.blind)?;
            Some((pair.key(), [a, self.mesh.twin(pair.h) / 3, pair.b]))
        });
        self.inner.held = held.collect();
    }

    fn list(&mut self, t: u32) {
        if !std::mem::replace(&mut self.inner.listed[t as usize], true) {
            self.inner.work.push(t);
        }
    }

    /// Lists a triangle that has changed and its neighbors for the next round.
    pub(super) fn touch(&mut self, t: u32) {
        self.list(t);
        for h in self.mesh.links[t as usize] {
            if self.owner[(h / 3) as usize] != FREE {
                self.list(h / 3);
            }
        }
    }

    fn claimed(&self, c: Candidate) -> impl Iterator<Item = u32> + use<> {
        [c.h / 3, self.mesh.twin(c.h) / 3, c.b].into_iter().filter(|&t| t != NONE)
    }

    fn owned(&self) -> Owned<'_> {
        Owned { mesh: self.mesh, positions: self.positions, owner: &self.owner }
    }

    fn candidate(&self, a: usize) -> Option<Candidate> {
        let before = |b: u32| self.inner.configurations[b as usize];
        self.owned().candidate(a, self.inner.configurations[a]?, before, self.inner.trial.blind)
    }

    /// Flips the pair of half-edge `h` from A to C, both of the same owner.
    fn flip(&mut self, h: u32) {
        let g = self.mesh.twin(h);
        let (right, left) = (self.mesh.origin(h), self.mesh.destination(h));
        let ((near, near_side), (far, far_side)) = (self.owned().corner(h), self.owned().corner(g));
        let diagonal = self.mesh.flip(h);
        let ((t, k), (u, j)) = (twin_code(h), twin_code(g));
        let Some(s) = place::owner(self.owner[t]) else { return };
        for (slot, word) in [t, u].into_iter().zip(words_of_flip(s, [k, j], [near_side, far_side])) {
            self.owner[slot] = word;
        }
        if near_side == 0 && far_side == 0 {
            self.mesh.set_constrained(diagonal, true);
            self.remaining -= 1;
        }
        self.touch(t as u32);
        self.touch(u as u32);
        for (v, spoke) in [(right, h), (left, g), (far, diagonal), (near, self.mesh.twin(diagonal))] {
            self.spokes[v as usize] = spoke;
        }
        for (v, side) in [(near, near_side), (far, far_side)] {
            self.degrees[v as usize] += u32::from(side == 0);
        }
    }
}
