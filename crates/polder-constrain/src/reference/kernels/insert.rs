//! The kernels of insertion.
//!
//! Lists are in the order in which their items come here; on a device they may be in any.

use super::super::fan::{Departure, depart_by_turning, depart_from, enter, leave};
use super::super::limits::{HUB, MOST_SPOKES, hub_walk};
use super::super::pairs::{Candidate, Owned, words_of_flip};
use super::super::place::{self, FREE};
use super::super::rebuild::rebuild;
use crate::Fault;
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE, next, prev, twin_code};
use polder_predicates::Sign;

/// The mark of a pair that was flipped.
pub const WON: u32 = 1 << 31;
/// In the second word of a pair, that no third triangle is claimed; the case, less one, stands above.
pub const NO_B: u32 = (1 << 30) - 1;
/// Instead of an edge in a stamp: listed, not flipped.
const LISTED: u32 = 3;

/// What kernels keep, by triangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scratch {
    /// Who owns it and how the owner runs.
    pub owner: Vec<u32>,
    /// The least key that claims it, else [`NONE`].
    pub claims: Vec<u32>,
    /// Four times the last round that flipped or listed it, and the edge along which it was flipped.
    pub stamps: Vec<u32>,
    /// The number of the last round.
    pub round: u32,
    /// How many pairs, the first in their list, were held during walks in which triangles got other owners.
    pub held: usize,
}

impl Scratch {
    /// For so many slots, before the first round.
    pub fn new(slots: usize) -> Self {
        Self { owner: vec![FREE; slots], claims: vec![NONE; slots], stamps: vec![0; slots], round: 0, held: 0 }
    }

    fn flipped(&self, t: u32) -> Option<u32> {
        let stamp = self.stamps[t as usize];
        (stamp >> 2 == self.round && stamp & 3 != LISTED).then_some(3 * t + (stamp & 3))
    }

    /// Lists a triangle unless it was listed or flipped.
    fn lists(&mut self, t: u32) -> bool {
        let stamp = &mut self.stamps[t as usize];
        let first = *stamp >> 2 != self.round;
        if first {
            *stamp = self.round << 2 | LISTED;
        }
        first
    }
}

/// What is known of a sub-constraint: the half-edge that it crosses first, whether it begins at its second end, and whether it
/// begins at a hub.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Begun {
    /// See there.
    pub first: u32,
    /// See there.
    pub reversed: bool,
    /// See there.
    pub at_hub: bool,
    /// How often it has walked from a hub.
    pub walks: u32,
    /// Whether its chain was too long once.
    pub long: bool,
    /// Once it walks, the triangle at its lower end.
    pub low: u32,
    /// Whether it became an edge and did not go by flips.
    pub done: bool,
}

impl Begun {
    /// Whether it goes by flips.
    pub fn by_flips(&self) -> bool {
        self.long || self.at_hub
    }
}

/// Which of these sub-constraints are no edges, how many are and become constrained ones, and how many of the others end at each
/// vertex.
pub fn list_walkers(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    sub_constraints: &[[u32; 2]],
    takes: &[u32],
    spokes: &[u32],
) -> (Vec<u32>, u32, Vec<u32>) {
    let (mut walkers, mut inserted, mut counts) = (Vec::new(), 0, vec![0; positions.len()]);
    for &s in takes {
        let [a, b] = sub_constraints[s as usize];
        match depart_by_turning(mesh, positions, spokes[a as usize], b) {
            Some(Departure::Along(h)) if mesh.destination(h) == b => {
                mesh.set_constrained(h, true);
                inserted += 1;
            }
            _ => {
                walkers.push(s);
                [a, b].into_iter().for_each(|v| counts[v as usize] += 1);
            }
        }
    }
    (walkers, inserted, counts)
}

/// What departures led to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Departed {
    /// Those that walk, or have to wait at a hub.
    pub walkers: Vec<u32>,
    /// How many are edges.
    pub inserted: u32,
    /// What claims at hubs led to.
    pub marked: Marked,
    /// The lowest that could not depart.
    pub fault: Option<Fault>,
}

/// Step 1 of an outer round, of these sub-constraints; with how many end at each vertex, if it is the first.
pub fn depart_walks(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    sub_constraints: &[[u32; 2]],
    (walkers, counts): (&[u32], Option<&[u32]>),
    begun: &mut [Begun],
    [spokes, degrees]: [&[u32]; 2],
    scratch: &mut Scratch,
) -> Departed {
    let mut departed = Departed::default();
    for &s in walkers {
        let ends = sub_constraints[s as usize];
        let before = begun[s as usize];
        let is_hub =
            |&v: &u32| counts.is_some_and(|counts| counts[v as usize] >= HUB && degrees[v as usize] <= MOST_SPOKES);
        let (mut at_hub, mut reversed, mut hint) = (false, degrees[ends[1] as usize] < degrees[ends[0] as usize], NONE);
        if counts.is_none() && before.at_hub {
            (at_hub, reversed, hint) = (true, before.reversed, before.first);
        } else if let Some(end) = ends.iter().position(is_hub) {
            (at_hub, reversed) = (true, end == 1);
        }
        let [from, to] = if reversed { [ends[1], ends[0]] } else { ends };
        match depart_from(mesh, positions, hint, spokes[from as usize], to) {
            Some(Departure::Across(first)) => {
                departed.walkers.push(s);
                let low = if reversed { 0 } else { first / 3 };
                begun[s as usize] = Begun { first, reversed, at_hub, low, ..before };
                if at_hub {
                    own(s, first, [0, -1, 1], begun, scratch, &mut departed.marked);
                }
            }
            Some(Departure::Along(h)) if mesh.destination(h) == to => {
                mesh.set_constrained(h, true);
                departed.inserted += 1;
            }
            Some(Departure::Along(_)) => departed.fault = departed.fault.or(Some(Fault::ThroughVertex(s))),
            None => departed.fault = departed.fault.or(Some(Fault::Lost(s))),
        }
    }
    departed
}

/// Those that walk, and those that have to wait at hubs.
pub fn admit_walks(walkers: &[u32], begun: &[Begun], scratch: &Scratch) -> [Vec<u32>; 2] {
    let walks = |&s: &u32| {
        let Begun { first, at_hub, .. } = begun[s as usize];
        !at_hub || place::owner(scratch.owner[(first / 3) as usize]) == Some(s)
    };
    let (admitted, barred) = walkers.iter().partition(|s| walks(s));
    [admitted, barred]
}

/// What walks led to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marked {
    /// Triangles that got their owner.
    pub triangles: Vec<u32>,
    /// Walkers that do not own their whole chain.
    pub losers: Vec<u32>,
    /// Triangles crossed, of all walks together.
    pub walked: u64,
    /// Walks from hubs that were not whole.
    pub partial: u32,
    /// Whether any of the triangles had another owner, maybe one of this round.
    pub stolen: bool,
    /// The lowest walker that could not go on.
    pub fault: Option<Fault>,
}

/// Steps 2 and 3 of an outer round. Those with chains of more than `longest` triangles go by flips.
pub fn mark_chains(
    mesh: &GhostMesh,
    positions: &[DVec2],
    sub_constraints: &[[u32; 2]],
    walkers: &[u32],
    (begun, longest): (&mut [Begun], u32),
    scratch: &mut Scratch,
) -> Marked {
    let (mut marked, mut long) = (Marked::default(), Vec::new());
    for &s in walkers {
        let ends = sub_constraints[s as usize];
        let Begun { first, reversed, at_hub, walks, .. } = begun[s as usize];
        let most = if at_hub { hub_walk(walks) } else { u64::MAX };
        begun[s as usize].walks += u32::from(at_hub);
        let line = if reversed { [ends[1], ends[0]] } else { ends }.map(|v| positions[v as usize]);
        let (mut h, mut near) = (first, 0);
        let mut fault = Some(Fault::Lost(s));
        let before = marked.walked;
        for step in 1..=mesh.slots() as u64 {
            own(s, h, [near, -1, 1], begun, scratch, &mut marked);
            if step == most {
                marked.losers.push(s);
                marked.partial += 1;
                fault = None;
                break;
            }
            if mesh.is_constrained(h) {
                fault = Some(Fault::Blocked(s));
                break;
            }
            let Some((g, side)) = enter(mesh, positions, h, line) else { break };
            if side == Sign::Zero {
                own(s, g, [0, 1, -1], begun, scratch, &mut marked);
                let done = mesh.apex(g) == ends[usize::from(!reversed)];
                if reversed {
                    begun[s as usize].low = g / 3;
                }
                fault = (!done).then_some(Fault::ThroughVertex(s));
                break;
            }
            h = leave(g, side);
            near = side as i8;
        }
        marked.fault = marked.fault.or(fault);
        long.extend((marked.walked - before > u64::from(longest)).then_some(s as usize));
    }
    for s in long {
        begun[s].long = true;
    }
    marked.losers.sort_unstable();
    marked.losers.dedup();
    marked
}

/// A walker claims the triangle of a half-edge; sides are those of the corners from there on.
fn own(s: u32, h: u32, from: [i8; 3], begun: &[Begun], scratch: &mut Scratch, marked: &mut Marked) {
    let (t, k) = twin_code(h);
    let Begun { reversed, .. } = begun[s as usize];
    let mut sides = [0; 3];
    for (i, side) in from.into_iter().enumerate() {
        sides[(k + i) % 3] = if reversed { -side } else { side };
    }
    marked.walked += 1;
    let word = place::word(s, sides);
    let is_done = place::owner(scratch.owner[t]).is_some_and(|owner| begun[owner as usize].done);
    let old = if is_done { FREE } else { scratch.owner[t] };
    scratch.owner[t] = old.min(word);
    let same = place::same_owner(old, word);
    if old == FREE || (same && !begun[s as usize].by_flips()) {
        scratch.stamps[t] = scratch.round << 2 | LISTED;
        marked.triangles.push(t as u32);
    } else if !same {
        marked.losers.extend(if old < word { Some(s) } else { place::owner(old) });
        if old > word {
            marked.stolen = true;
            if scratch.stamps[t] != scratch.round << 2 | LISTED {
                scratch.stamps[t] = scratch.round << 2 | LISTED;
                marked.triangles.push(t as u32);
            }
        }
    }
}

/// Step 4 of an outer round: how many chains of these walkers, of which some do not own theirs, were rebuilt; nothing, if the
/// mesh is no triangulation.
pub fn rebuild_chains(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    [walkers, losers]: [&[u32]; 2],
    begun: &[Begun],
    scratch: &Scratch,
    [spokes, degrees]: [&mut [u32]; 2],
) -> Option<u32> {
    let whole = walkers.iter().filter(|s| !losers.contains(s)).map(|&s| begun[s as usize]);
    let mut rebuilt = 0;
    for Begun { low, .. } in whole.filter(|begun| !begun.by_flips()) {
        let first = 3 * low + place::outward(scratch.owner[low as usize])?;
        rebuild(mesh, positions, &scratch.owner, first, [&mut *spokes, &mut *degrees])?;
        rebuilt += 1;
    }
    Some(rebuilt)
}

/// The pairs that may be flipped because triangles got owners that go by flips; they claim their triangles.
pub fn configure_pairs(
    mesh: &GhostMesh,
    positions: &[DVec2],
    marked: &[u32],
    begun: &[Begun],
    scratch: &mut Scratch,
) -> Vec<[u32; 2]> {
    let by_flips = |t: &u32| {
        let owner = place::owner(scratch.owner[*t as usize]);
        owner.is_some_and(|s| begun[s as usize].by_flips())
    };
    let owned = Owned { mesh, positions, owner: &scratch.owner };
    let is_new = |t: u32| scratch.stamps[t as usize] == scratch.round << 2 | LISTED;
    let old_or_none = |t: Option<u32>| t.filter(|&t| !is_new(t));
    let mut found = Vec::new();
    for t in marked.iter().copied().filter(by_flips) {
        found.extend(look(owned, t));
        found.extend(old_or_none(beside(owned, t, false)).and_then(|a| look(owned, a)));
        let after = old_or_none(beside(owned, t, true)).filter(|&a| !beside(owned, a, true).is_some_and(is_new));
        found.extend(after.and_then(|a| look(owned, a)).filter(|pair| pair.case > 1));
    }
    found.into_iter().map(|pair| claim(mesh, pair, &mut scratch.claims)).collect()
}

/// The triangle after or before one along its owner.
fn beside(owned: Owned<'_>, t: u32, after: bool) -> Option<u32> {
    let word = owned.owner[t as usize];
    let gate = if after { place::outward(word) } else { place::inward(word) }?;
    let x = owned.mesh.twin(3 * t + gate) / 3;
    place::same_owner(word, owned.owner[x as usize]).then_some(x)
}

fn look(owned: Owned<'_>, a: u32) -> Option<Candidate> {
    let (_, own) = owned.next_pair(a as usize)?;
    owned.candidate(a as usize, own, |b| owned.next_pair(b as usize).map(|(_, c)| c), false)
}

fn claim(mesh: &GhostMesh, pair: Candidate, claims: &mut [u32]) -> [u32; 2] {
    let b = if pair.b == NONE { NO_B } else { pair.b };
    let entry = [pair.h, u32::from(pair.case - 1) << 30 | b];
    for t in claimed(mesh, entry) {
        claims[t as usize] = claims[t as usize].min(pair.key());
    }
    entry
}

fn claimed(mesh: &GhostMesh, [h, word]: [u32; 2]) -> impl Iterator<Item = u32> + use<> {
    [h / 3, mesh.twin(h) / 3, word & NO_B].into_iter().filter(|&t| t != NO_B)
}

/// Step 3 of an inner round, first half: flips the pairs that have all they claimed, marks them [`WON`], and counts them by
/// case, and then those that made an edge of their owner. Links around the flips keep their names from before the round.
pub fn flip_pairs(
    mesh: &mut GhostMesh,
    scratch: &mut Scratch,
    pairs: &mut [[u32; 2]],
    [spokes, degrees]: [&mut [u32]; 2],
) -> [u64; 4] {
    let since = scratch.round;
    scratch.round += 1;
    let mut flips = [0; 4];
    let wins: Vec<bool> = pairs
        .iter()
        .enumerate()
        .map(|(i, &entry)| {
            let key = crate::reference::claim_key((entry[1] >> 30) as u8 + 1, entry[0] / 3);
            let stays = |t: u32| i >= scratch.held || scratch.stamps[t as usize] >> 2 < since;
            claimed(mesh, entry).all(|t| scratch.claims[t as usize] == key && stays(t))
        })
        .collect();
    for (entry, _) in pairs.iter_mut().zip(wins).filter(|(_, wins)| *wins) {
        let h = entry[0];
        let g = mesh.twin(h);
        let outer = [next(g), next(h)].map(|side| (mesh.twin(side), mesh.is_constrained(side)));
        let [near, right, left, far] = [mesh.apex(h), mesh.origin(h), mesh.destination(h), mesh.apex(g)];
        let sides = [h, g].map(|h| place::side(scratch.owner[(h / 3) as usize]));
        let zero = sides == [0, 0];
        for (side, corner, (link, constrained)) in [(h, far, outer[0]), (g, near, outer[1])] {
            let (t, k) = twin_code(side);
            mesh.triangles[t][(k + 2) % 3] = corner;
            mesh.links[t][k] = link;
            mark(mesh, side, constrained);
            mark(mesh, next(side), zero);
            scratch.stamps[t] = scratch.round << 2 | k as u32;
        }
        mesh.link(next(h), next(g));
        let ((t, k), (u, j)) = (twin_code(h), twin_code(g));
        if let Some(s) = place::owner(scratch.owner[t]) {
            [scratch.owner[t], scratch.owner[u]] = words_of_flip(s, [k, j], sides);
        }
        spokes[right as usize] = h;
        spokes[left as usize] = g;
        for (v, side) in [near, far].into_iter().zip(sides) {
            degrees[v as usize] += u32::from(side == 0);
        }
        flips[(entry[1] >> 30) as usize] += 1;
        flips[3] += u64::from(zero);
        entry[0] |= WON;
    }
    flips
}

/// Step 3, second half, and steps 1 and 2 of the next round: renews links around the flips, gives claimed triangles back, and
/// returns the pairs of the next round, which claim theirs.
pub fn advance_pairs(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    pairs: &[[u32; 2]],
    scratch: &mut Scratch,
) -> Vec<[u32; 2]> {
    let mut looks = Vec::new();
    scratch.claims.fill(NONE);
    scratch.held = 0;
    for &[entry, _] in pairs.iter().filter(|pair| pair[0] & WON != 0) {
        let h = entry & !WON;
        let g = prev(mesh.twin(next(h)));
        for side in [h, g, prev(h), prev(g)] {
            let mut outer = mesh.twin(side);
            if let Some(edge) = scratch.flipped(outer / 3) {
                if outer == next(edge) {
                    outer = prev(mesh.twin(outer));
                }
                mesh.links[(side / 3) as usize][(side % 3) as usize] = outer;
            } else {
                mesh.links[(outer / 3) as usize][(outer % 3) as usize] = side;
            }
        }
        looks.extend([h / 3, g / 3].into_iter().filter(|&t| scratch.owner[t as usize] != FREE));
    }
    let changed = looks.clone();
    for t in changed {
        let owned = Owned { mesh, positions, owner: &scratch.owner };
        for x in [beside(owned, t, false), beside(owned, t, true)].into_iter().flatten() {
            if scratch.lists(x) {
                looks.push(x);
            }
        }
    }
    for &[entry, _] in pairs.iter().filter(|pair| pair[0] & WON == 0) {
        if scratch.lists(entry / 3) {
            looks.push(entry / 3);
        }
    }
    let owned = Owned { mesh, positions, owner: &scratch.owner };
    let found: Vec<Candidate> = looks.into_iter().filter_map(|a| look(owned, a)).collect();
    found.into_iter().map(|pair| claim(mesh, pair, &mut scratch.claims)).collect()
}

/// Rounds from claims to claims, at most `most`, while there are pairs and fewer than `least` of them (four times as many
/// after the first): the pairs left, the rounds, and the flips as [`flip_pairs`] counts them.
pub fn pair_tail(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    pairs: &[[u32; 2]],
    [least, most]: [usize; 2],
    scratch: &mut Scratch,
    [spokes, degrees]: [&mut [u32]; 2],
) -> (Vec<[u32; 2]>, u64, [u64; 4]) {
    let mut pairs = pairs.to_vec();
    let (mut rounds, mut flips) = (0, [0; 4]);
    let mut limit = least;
    while !pairs.is_empty() && pairs.len() < limit && rounds < most as u64 {
        limit = least.saturating_mul(4);
        let made = flip_pairs(mesh, scratch, &mut pairs, [&mut *spokes, &mut *degrees]);
        flips.iter_mut().zip(made).for_each(|(sum, n)| *sum += n);
        pairs = advance_pairs(mesh, positions, &pairs, scratch);
        rounds += 1;
    }
    (pairs, rounds, flips)
}

fn mark(mesh: &mut GhostMesh, h: u32, yes: bool) {
    let (t, k) = twin_code(h);
    mesh.constrained[t] = mesh.constrained[t] & !(1 << k) | u8::from(yes) << k;
}
