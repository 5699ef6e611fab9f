//! All proper crossings of constraints, without testing all pairs.
//!
//! 1. Every sub-constraint walks again and counts itself in each triangle that it runs through, or in one at the edge
//!    that it is. A triangle with one of them has no crossing.
//! 2. The triangles are divided into chunks of a bounded number of chords. For each chunk all walk once more and leave
//!    their chords; then each triangle is searched by itself (see the module `chords`).
//! 3. Each crossing of two sub-constraints is one of every pair of constraints that run along them.
//!
//! Each crossing is found exactly once: in the interior of a triangle, at the lower half-edge of an edge that both run
//! across, or as the crossing of an edge. Two segments cross at one point at most, so that no pair is found twice.
//!
//! Where there are more crossings than asked for, the first ones in the order of (higher constraint, lower constraint)
//! are kept: prefixes of the constraints are searched until one has enough, and not too many.
//!
//! Where few constraints run through very many triangles, or very many cross, pairs are tested after all, in that order (see the
//! module `pairwise`). Of 34,000 constraints more than a million pairs cross in `random(45_000_000, 200_000)` of the workspace's
//! tests: `many_random_inputs_give_one_result` took 58 s on that input (2 cores) by chords and prefixes, and takes 9.

use super::chords::{Chord, Place, Room};
use super::fan::{enter, leave};
use super::pairwise::pairwise;
use crate::{ConstrainError, Crossings, Walk};
use glam::DVec2;
use polder_mesh::{GhostMesh, twin_code};
use polder_predicates::Sign;
use std::ops::Range;

/// So many chords are in memory at a time, or four a triangle if that is more, unless a single triangle has more still.
const CHUNK: usize = 1 << 23;
/// A search that finds this many times more pairs than asked for is broken off and done in prefixes.
const PATIENCE: usize = 4;
/// As many pairs are tested in the time that a chord takes, about.
const TESTS: u64 = 32;

/// The pairs of constraints that cross properly: at a point that is no vertex.
///
/// `mesh` and `positions` are those that were walked. At most `max_crossings` pairs are listed, sorted.
///
/// # Errors
///
/// [`ConstrainError::Lost`] where it shows that the mesh is not the one that was walked.
pub fn crossings(
    mesh: &GhostMesh,
    positions: &[DVec2],
    walk: &Walk,
    max_crossings: usize,
) -> Result<Crossings, ConstrainError> {
    crossings_within(mesh, positions, walk, max_crossings, CHUNK.max(4 * mesh.slots()), TESTS)
}

/// With chunks of so many chords, and up to so many tests of pairs in place of a chord.
fn crossings_within(
    mesh: &GhostMesh,
    positions: &[DVec2],
    walk: &Walk,
    max_crossings: usize,
    chunk: usize,
    tests: u64,
) -> Result<Crossings, ConstrainError> {
    let search = Search { mesh, positions, walk, parents: Parents::new(walk), chunk };
    let constraints = walk.chains.len() as u32;
    let enough = max_crossings.saturating_mul(PATIENCE).saturating_add(1);
    let most_tests = tests.saturating_mul(walk.intersections() + walk.pieces.len() as u64);
    let tested = |most: u64| pairwise(positions, walk, &search.parents, max_crossings, most);
    let all_tests = (walk.pieces.len() as u64).saturating_mul(walk.sub_constraints.len() as u64);
    // Where very many cross, a try that costs next to nothing may do.
    let mut found = tested(if all_tests <= most_tests { most_tests } else { most_tests / 64 });
    if found.is_none() {
        found = match search.prefix(constraints, enough)? {
            Found::All(pairs) => Some(pairs),
            Found::TooMany => tested(most_tests),
        };
    }
    let mut pairs = found.map_or_else(|| search.shortest(constraints, max_crossings, enough), Ok)?;
    let truncated = pairs.len() > max_crossings;
    if truncated {
        pairs.sort_unstable_by_key(|&[i, j]| (j, i));
        pairs.truncate(max_crossings);
    }
    pairs.sort_unstable();
    Ok(Crossings { pairs, truncated })
}

/// For each sub-constraint the constraints that run along it, in order.
pub(super) struct Parents {
    offsets: Vec<u32>,
    constraints: Vec<u32>,
}

impl Parents {
    fn new(walk: &Walk) -> Self {
        let mut offsets = vec![0u32; walk.sub_constraints.len() + 1];
        for &s in &walk.pieces {
            offsets[s as usize] += 1;
        }
        let mut sum = 0;
        for offset in &mut offsets {
            sum += std::mem::replace(offset, sum);
        }
        let mut constraints = vec![0; walk.pieces.len()];
        for i in 0..walk.chains.len() {
            for &s in walk.pieces(i) {
                let place = &mut offsets[s as usize];
                constraints[*place as usize] = i as u32;
                *place += 1;
            }
        }
        // Each offset has moved to the end of its list, which is where the next one begins.
        offsets.rotate_right(1);
        offsets[0] = 0;
        Self { offsets, constraints }
    }

    /// Those below `prefix`.
    pub(super) fn of(&self, s: u32, prefix: u32) -> &[u32] {
        let all = &self.constraints[self.offsets[s as usize] as usize..self.offsets[s as usize + 1] as usize];
        &all[..all.partition_point(|&i| i < prefix)]
    }
}

enum Found {
    All(Vec<[u32; 2]>),
    TooMany,
}

struct Search<'a> {
    mesh: &'a GhostMesh,
    positions: &'a [DVec2],
    walk: &'a Walk,
    parents: Parents,
    chunk: usize,
}

impl Search<'_> {
    /// All crossings of a prefix that has more than `max`, but, if that is possible, no more than `enough`; the whole
    /// has more than that. Prefixes double in length until one has too many, then the space between is halved.
    fn shortest(&self, whole: u32, max: usize, enough: usize) -> Result<Vec<[u32; 2]>, ConstrainError> {
        let (mut few, mut many) = (0, whole);
        while many - few > 1 {
            let middle = (2 * few).max(1024).min(few + (many - few) / 2);
            match self.prefix(middle, enough)? {
                Found::All(pairs) if pairs.len() > max => return Ok(pairs),
                Found::All(_) => few = middle,
                Found::TooMany => many = middle,
            }
        }
        // The last constraint alone brings the rest, and it crosses each other one once at most.
        match self.prefix(many, usize::MAX)? {
            Found::All(pairs) => Ok(pairs),
            Found::TooMany => Ok(Vec::new()),
        }
    }

    /// All crossings among the first `prefix` constraints, unless they are `limit` or more.
    fn prefix(&self, prefix: u32, limit: usize) -> Result<Found, ConstrainError> {
        let triangles = self.mesh.slots();
        // Step 1.
        let mut starts = vec![0u32; triangles + 1];
        self.visit(prefix, |t, _| starts[t] = starts[t].saturating_add(1))?;
        let mut pairs = Vec::new();
        let mut room = Room::default();
        let mut from = 0;
        while from < triangles {
            // Step 2.
            let (mut to, mut total) = (from, 0);
            while to < triangles {
                let count = if starts[to] < 2 { 0 } else { starts[to] as usize };
                if total > 0 && total + count > self.chunk {
                    break;
                }
                starts[to] = total as u32;
                total += count;
                to += 1;
            }
            if total > 0
                && !self.chunk_of_triangles(prefix, from..to, total, &mut starts, &mut room, &mut pairs, limit)?
            {
                return Ok(Found::TooMany);
            }
            from = to;
        }
        Ok(Found::All(pairs))
    }

    /// Searches some triangles; false if `limit` was reached. `starts` has the place of each one's first chord.
    #[expect(clippy::too_many_arguments, reason = "the state of one search, in one place alone")]
    fn chunk_of_triangles(
        &self,
        prefix: u32,
        range: Range<usize>,
        total: usize,
        starts: &mut [u32],
        room: &mut Room,
        pairs: &mut Vec<[u32; 2]>,
        limit: usize,
    ) -> Result<bool, ConstrainError> {
        let end = |starts: &[u32], t: usize| if t + 1 < range.end { starts[t + 1] as usize } else { total };
        let ends: Vec<u32> = range.clone().map(|t| end(starts, t) as u32).collect();
        let mut chords = vec![Chord::along(0, 0); total];
        self.visit(prefix, |t, chord| {
            // A triangle with one chord was given no room.
            if range.contains(&t) && starts[t] < ends[t - range.start] {
                chords[starts[t] as usize] = chord;
                starts[t] += 1;
            }
        })?;
        let line = |s: u32| self.walk.sub_constraints[s as usize].map(|v| self.positions[v as usize]);
        let mut from = 0;
        for t in range.clone() {
            let to = ends[t - range.start] as usize;
            if from == to {
                continue;
            }
            let h = 3 * t as u32;
            let place = Place {
                corners: self.mesh.triangles[t].map(|v| self.positions.get(v as usize).copied().unwrap_or_default()),
                lower: [0, 1, 2].map(|k| h + k < self.mesh.twin(h + k)),
            };
            // Step 3.
            let mut found = |p: u32, q: u32| {
                for &i in self.parents.of(p, prefix) {
                    for &j in self.parents.of(q, prefix) {
                        if pairs.len() >= limit {
                            return false;
                        }
                        pairs.push([i.min(j), i.max(j)]);
                    }
                }
                true
            };
            if !room.crossings(&place, &chords[from..to], &line, &mut found) {
                return Ok(false);
            }
            from = to;
        }
        Ok(true)
    }

    /// Shows every chord of every sub-constraint of the first `prefix` constraints, with its triangle.
    fn visit(&self, prefix: u32, mut see: impl FnMut(usize, Chord)) -> Result<(), ConstrainError> {
        for (s, (&ends, &h)) in self.walk.sub_constraints.iter().zip(&self.walk.departures).enumerate() {
            let s = s as u32;
            if self.parents.of(s, prefix).is_empty() {
                continue;
            }
            let edges = self.walk.crossed_edges[s as usize];
            if edges == 0 {
                let (t, k) = twin_code(h.min(self.mesh.twin(h)));
                see(t, Chord::along(s, k as u8));
                continue;
            }
            let line = ends.map(|v| self.positions[v as usize]);
            let (mut h, mut inward) = (h, 3 + (h % 3) as u8);
            for _ in 0..edges {
                let (t, k) = twin_code(h);
                see(t, Chord::across(s, inward, k as u8));
                let lost = ConstrainError::Lost { ends };
                let Some((g, side)) = enter(self.mesh, self.positions, h, line) else { return Err(lost) };
                if side == Sign::Zero {
                    let (t, k) = twin_code(g);
                    see(t, Chord::across(s, k as u8, 3 + k as u8));
                    break;
                }
                inward = (g % 3) as u8;
                h = leave(g, side);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
