//! The kernels of stage 3 but for those that take sites out.
//!
//! The state of a site that is not pinned is its number. That of a pinned one has the bit [`PINNED`], and its place in the
//! list of pinned sites, then the neighbor that it waits for, and once it is tried [`TRIED`], the round, and [`FREED`] if
//! that went well. What is appended to
//! a list on the device in order of arrival is ascending here.

use super::super::star::star;
use glam::DVec2;
use polder_flip::priority;
use polder_mesh::{DELETED, GHOST, GhostMesh, prev};
use polder_predicates::{Sign, orient2d};

/// The bit of pinned sites.
pub const PINNED: u32 = 1 << 31;
/// The bit of those that were tried at their true positions.
pub const TRIED: u32 = 1 << 30;
/// The bit of those that can stay there.
pub const FREED: u32 = 1 << 29;
/// Entries of a row of counts: the rounds of a batch, and one more.
pub const ROW: usize = 32;

/// Places in the words that steer rounds; rows of counts begin at their first word.
#[expect(missing_docs, reason = "named as in the reports of rounds")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    PinLeft = 0,
    OutLeft = 4,
    Empty = 12,
    PinBase = 20,
    PinRounds = 21,
    UnpinBase = 22,
    UnpinRounds = 23,
    UnpinStarted = 24,
    OutRounds = 25,
    Chain = 26,
    Bad = 27,
    Stuck = 28,
    PinCounts = 32,
    UnpinCounts = 96,
    OutCounts = 160,
}

/// How many words there are.
pub const WORDS: usize = 320;

/// The true positions of all points in the new order, and the state of each site.
pub fn shift_move(points: &[DVec2], order: &[u32], sites: usize) -> (Vec<DVec2>, Vec<u32>) {
    (order.iter().map(|&i| points[i as usize]).collect(), (0..sites as u32).collect())
}

/// Half-edges out of the corners, one each, of those triangles among `slots` that are not counterclockwise.
pub fn pin_triangles(
    mesh: &GhostMesh,
    positions: &[DVec2],
    state: &[u32],
    slots: impl Iterator<Item = usize>,
) -> Vec<u32> {
    let mut found = Vec::new();
    for t in slots.filter(|&t| mesh.is_finite(t)) {
        let [a, b, c] = mesh.triangles[t].map(|v| positions[v as usize]);
        if orient2d(a, b, c) != Sign::Positive {
            found.extend((0..3).map(|k| prev(3 * t as u32 + k)));
        }
    }
    found.retain(|&h| state[mesh.origin(h) as usize] & PINNED == 0);
    found.sort_unstable_by_key(|&h| (mesh.origin(h), h));
    found.dedup_by_key(|h| mesh.origin(*h));
    found
}

/// The half-edges that lead to the ghost, ascending: what [`pin_triangles`] lists besides.
pub fn hull_edges(mesh: &GhostMesh) -> Vec<u32> {
    (0..3 * mesh.slots() as u32).filter(|&h| mesh.destination(h) == GHOST).collect()
}

/// Puts the origins of `fresh` on their centers, and gives half-edges out of those not pinned yet around which a triangle
/// with a fresh corner is not counterclockwise.
pub fn pin_stars(
    mesh: &GhostMesh,
    centers: &[DVec2],
    positions: &mut [DVec2],
    state: &[u32],
    fresh: &[u32],
) -> Vec<u32> {
    for &h in fresh {
        let v = mesh.origin(h) as usize;
        positions[v] = centers[v];
    }
    let around = fresh.iter().flat_map(|&h| star(mesh, h)).map(|h| (h / 3) as usize);
    pin_triangles(mesh, positions, state, around)
}

/// For each half-edge on a list the neighbors around its origin in order, beginning after its end: eight words, the rest
/// [`DELETED`], and all of them where there are more neighbors. What [`pin_stars`] leaves for [`unpin_stars`].
pub fn rings(mesh: &GhostMesh, list: &[u32]) -> Vec<u32> {
    let ring = |&h: &u32| {
        let mut ends: Vec<u32> = star(mesh, h).map(|h| mesh.apex(h)).collect();
        if ends.len() > 8 {
            ends.clear();
        }
        ends.resize(8, DELETED);
        ends
    };
    list.iter().flat_map(ring).collect()
}

/// Tries the origins of those half-edges `waiting` whose turn it is, and returns the others, which remember whom they wait
/// for: in rounds but the first, they wait while that one does.
pub fn unpin_stars(
    mesh: &GhostMesh,
    truth: &[DVec2],
    positions: &mut [DVec2],
    state: &mut [u32],
    waiting: &[u32],
    round: u32,
) -> Vec<u32> {
    let before = state.to_vec();
    let is_waiting = |u: u32| before[u as usize] & PINNED != 0 && before[u as usize] & TRIED == 0;
    let (mut turn, mut later) = (Vec::new(), Vec::new());
    for &h in waiting {
        let v = mesh.origin(h);
        if round > 0 && is_waiting(before[v as usize] & !PINNED) {
            later.push(h);
            continue;
        }
        let ends = star(mesh, h).map(|spoke| mesh.destination(spoke));
        let earlier = ends.filter(|&u| u < DELETED && priority(u) < priority(v) && is_waiting(u));
        match earlier.max_by_key(|&u| priority(u)) {
            Some(u) => {
                state[v as usize] = PINNED | u;
                later.push(h);
            }
            None => turn.push(h),
        }
    }
    for h in turn {
        let v = mesh.origin(h) as usize;
        let before = std::mem::replace(&mut positions[v], truth[v]);
        let is_free = star(mesh, h).map(|h| (h / 3) as usize).filter(|&t| mesh.is_finite(t)).all(|t| {
            let [a, b, c] = mesh.triangles[t].map(|v| positions[v as usize]);
            orient2d(a, b, c) == Sign::Positive
        });
        if !is_free {
            positions[v] = before;
        }
        state[v] = PINNED | TRIED | if is_free { FREED } else { 0 } | round;
    }
    later
}

/// The final state of the origins of `all`, these sites, and those of them that are still pinned.
pub fn unpin_finish(mesh: &GhostMesh, state: &mut [u32], all: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let sites: Vec<u32> = all.iter().map(|&h| mesh.origin(h)).collect();
    let mut stuck = Vec::new();
    for (&v, &h) in sites.iter().zip(all) {
        let is_free = state[v as usize] & FREED != 0;
        state[v as usize] = if is_free { v } else { PINNED | h };
        if !is_free {
            stuck.push(v);
        }
    }
    stuck.sort_unstable();
    (sites, stuck)
}

/// After a batch of so many rounds of phase 0 (pin), 1 (unpin) or 2 (take out).
pub fn shift_advance(words: &mut [u32], slots: &mut u32, phase: u32, rounds: u32) {
    let counts = [Word::PinCounts, Word::UnpinCounts, Word::OutCounts][phase as usize] as usize;
    let chain = if phase == 2 { words[Word::Chain as usize] } else { 0 };
    let row = words[counts..counts + rounds as usize].to_vec();
    let busy = (0..).zip(&row).filter(|&(k, &count)| count != 0 && (chain == 0 || k < chain)).count() as u32;
    let left = if chain == 0 { words[counts + rounds as usize] } else { 0 };
    if phase == 2 && words[Word::OutRounds as usize] == 0 {
        words[Word::Stuck as usize] = row[0];
    }
    words[counts..counts + if phase == 2 { 5 } else { 1 } * ROW].fill(0);
    words[counts] = left;
    match phase {
        0 => {
            words[Word::PinRounds as usize] += busy;
            words[Word::PinBase as usize] += row.iter().sum::<u32>();
            words[Word::PinLeft as usize] = left;
            if left == 0 && words[Word::UnpinStarted as usize] == 0 {
                words[Word::UnpinStarted as usize] = 1;
                words[Word::UnpinCounts as usize] = words[Word::PinBase as usize];
                words[Word::Bad as usize] = words[Word::PinBase as usize];
            }
        }
        1 => {
            words[Word::UnpinRounds as usize] += busy;
            words[Word::UnpinBase as usize] += rounds;
            words[Word::PinLeft as usize] = words[Word::PinLeft as usize].max(left);
            words[Word::UnpinStarted as usize] = words[Word::UnpinStarted as usize].min(1) * 2;
        }
        _ => {
            words[Word::OutRounds as usize] += busy;
            words[Word::OutLeft as usize] = left;
            words[Word::Chain as usize] = 0;
            if chain != 0 {
                words[Word::Empty as usize] = 1;
                *slots = 0;
            }
        }
    }
}
