//! Sub-constraints become edges. \[QCT\] section 4, algorithm 4: the outer loop.
//!
//! An *outer round*:
//!
//! 1. Each sub-constraint that does not own its whole chain yet leaves the star of one of its ends. If it is an edge, it
//!    becomes a constrained one and is done. Where many end at one vertex, a *hub*, they begin there and claim the triangle
//!    into which they leave it: who does not get it waits for the next outer round.
//! 2. The others walk and claim each triangle that they cross; of all that claim it, the sub-constraint with the least
//!    priority owns it, and the triangle remembers by which edges its owner comes in and goes out (see the module `place`).
//! 3. A sub-constraint that owns its whole chain has walked for the last time.
//! 4. The chain of one that owns it all, if it has at most [`LONGEST_REBUILT`] triangles, is rebuilt at once (see the module
//!    `rebuild`). A sub-constraint that once had a longer one goes *by flips* from then on, and so do all that begin at hubs.
//! 5. A few inner rounds flip pairs of triangles that one who goes by flips owns (see the module `inner`): more of them the
//!    longer the walks were, which are to be saved. If each that is not in yet owns its whole chain, they go on to the end.
//!
//! The sub-constraint with the least priority owns its whole chain, so that it is rebuilt or inserted by inner rounds alone
//! (\[QCT\] Claim 1), and every outer round flips or inserts something, or has someone walk farther the next time: a round that
//! does none of this ends the loop with an error, as does the bound on rounds.
//!
//! Departures from the paper:
//!
//! - There all goes by flips. Most chains are short, and one of eight triangles takes eight flips in several rounds, each of
//!   which reads and writes as much as it takes to rebuild two triangles.
//! - Ownership stays from one outer round to the next. It stays right: a flip replaces two triangles that their owner
//!   crosses, so who crosses the new ones has crossed the old ones. A sub-constraint that owns its whole chain need not walk
//!   again; only the others do. Who has waited at a hub may come later and take a triangle from its owner, who then walks
//!   again. Pairs that the owner was about to flip there are not flipped, though their claims hold for one round.
//! - Hubs. Of 40,000 from one vertex all cross the triangles around it, of which only a few get their whole chain in any
//!   round. All of them walked 73,997,493 triangles in 31 outer rounds; this way 4,452,518, in 45, with about as many inner
//!   rounds. A later walk begins where the last one left the hub: flips there only divide triangles, nearly always.
//!   Walks from hubs are not whole at first (see [`HUB_WALK`](super::HUB_WALK)).
//! - The least hash of the id wins, not the least id.
//! - Not taken: to let a sub-constraint wait until the one with the least priority on its chain is done. Of 40,000 from
//!   one vertex that saves a fifth of the steps of all walks, but costs a third more outer rounds; of 100,000 strewn
//!   ones it costs a quarter more steps and half as many rounds again.
//! - A walk begins at the end with fewer edges, which makes all beginnings together linear: sub-constraints that do not
//!   cross form a planar graph.
//! - A sub-constraint that meets a constrained edge or a vertex is an error with their names. Crossings are to be found
//!   before, by [`crossings`](super::crossings()): here some are met only after others have been inserted. But one is met for
//!   certain: no constrained edge is ever replaced, by a walk nor by a flip, so that in the end all of them are edges of one mesh.

use super::configuration::Side;
use super::fan::{Departure, depart_from, enter, leave};
use super::inner::{Inner, Trial};
use super::limits::{
    HUB, INNER_ROUNDS, LEAST_REBUILT, LONG_CHAIN, LONGEST_REBUILT, MOST_SPOKES, MOST_SUB_CONSTRAINTS, MOST_TIMES,
    USUAL_ROUNDS, hub_walk,
};
use super::place::{self, FREE};
use super::rebuild::rebuild;
use crate::{ConstrainError, InsertReport};
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE, twin_code};
use polder_predicates::Sign;

/// Makes each sub-constraint a constrained edge of the mesh, by flips.
///
/// A sub-constraint is a pair of distinct vertices, the lower one first, with no vertex between them; they are sorted,
/// as [`Walk`](crate::Walk) gives them. They may not cross each other nor a constrained edge that is there already. The
/// mesh may be any triangulation of a convex hull, Delaunay or not; afterwards it is one that need not be Delaunay.
///
/// The result, slots and all, depends on the mesh and the set of sub-constraints alone.
///
/// # Errors
///
/// [`ConstrainError::Blocked`] and [`ConstrainError::ThroughVertex`] name the lowest sub-constraint of the round at
/// fault; [`ConstrainError::NotAVertex`], [`ConstrainError::MissingPosition`], [`ConstrainError::Lost`] and
/// [`ConstrainError::BoundExceeded`] say that the mesh is not what it should be. The mesh is left as it was then.
pub fn insert(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    sub_constraints: &[[u32; 2]],
) -> Result<InsertReport, ConstrainError> {
    let mut insertion = Insertion::new(mesh, positions, sub_constraints)?;
    while !insertion.is_done() {
        insertion.outer_round()?;
    }
    Ok(insertion.report())
}

/// An insertion that is made round by round, for those who want to look at what lies between.
#[derive(Debug)]
pub struct Insertion<'a> {
    pub(super) mesh: &'a mut GhostMesh,
    pub(super) positions: &'a [DVec2],
    sub_constraints: &'a [[u32; 2]],
    /// Sub-constraints that do not own their whole chain, in order.
    waiting: Vec<u32>,
    /// How many are not in yet.
    pub(super) remaining: usize,
    /// For each triangle the word that says who owns it, or [`FREE`].
    pub(super) owner: Vec<u32>,
    /// For each sub-constraint whether it does not own its whole chain, and those that do not, in any order.
    lost: Vec<bool>,
    losers: Vec<u32>,
    /// For each sub-constraint that begins at a hub which end that is, and the half-edge opposite it by which it left it last.
    hubs: Vec<Option<(usize, u32)>>,
    /// For each how often it has walked; and how many walks, of all together, were not whole.
    walks: Vec<u32>,
    partial_walks: u64,
    /// For each vertex a half-edge that begins there, and how many do; of later changes only edges added to the ends of
    /// sub-constraints are counted.
    pub(super) spokes: Vec<u32>,
    pub(super) degrees: Vec<u32>,
    pub(super) inner: Inner,
    /// For each sub-constraint whether it goes by flips.
    pub(super) by_flips: Vec<bool>,
    /// Triangles that got their owner in this outer round, and those that an owner had before who did not go by flips then.
    marked: Vec<u32>,
    /// The chains that are to be rebuilt: sub-constraints, and half-edges by which they leave their lower ends.
    short: Vec<(u32, u32)>,
    longest_rebuilt: u32,
    least_rebuilt: u32,
    inner_rounds: u32,
    /// So many times as many of them in this outer round.
    times: u32,
    bound: u64,
    pub(super) report: InsertReport,
}

impl<'a> Insertion<'a> {
    /// Nothing done yet.
    ///
    /// # Errors
    ///
    /// [`ConstrainError::NotAVertex`], [`ConstrainError::MissingPosition`].
    pub fn new(
        mesh: &'a mut GhostMesh,
        positions: &'a [DVec2],
        sub_constraints: &'a [[u32; 2]],
    ) -> Result<Self, ConstrainError> {
        super::check_positions(mesh, positions)?;
        let spokes = mesh.half_edge_of_vertex(positions.len());
        for (constraint, &[a, b]) in sub_constraints.iter().enumerate() {
            let is_vertex = |v: u32| spokes.get(v as usize).is_some_and(|&h| h != NONE);
            if let Some(vertex) = [a, b].into_iter().find(|&v| !is_vertex(v) || a == b) {
                return Err(ConstrainError::NotAVertex { constraint, vertex });
            }
        }
        let mut degrees = vec![0; positions.len()];
        for &v in mesh.triangles.iter().flatten() {
            if let Some(degree) = degrees.get_mut(v as usize) {
                *degree += 1;
            }
        }
        let slots = mesh.slots();
        if sub_constraints.len() > MOST_SUB_CONSTRAINTS {
            let count = sub_constraints.len();
            return Err(ConstrainError::TooMany { count, limit: MOST_SUB_CONSTRAINTS });
        }
        Ok(Self {
            mesh,
            positions,
            sub_constraints,
            waiting: (0..sub_constraints.len() as u32).collect(),
            remaining: sub_constraints.len(),
            owner: vec![FREE; slots],
            lost: vec![false; sub_constraints.len()],
            losers: Vec::new(),
            hubs: vec![None; sub_constraints.len()],
            walks: vec![0; sub_constraints.len()],
            partial_walks: 0,
            spokes,
            degrees,
            inner: Inner::new(slots),
            by_flips: vec![false; sub_constraints.len()],
            marked: Vec::new(),
            short: Vec::new(),
            longest_rebuilt: LONGEST_REBUILT,
            least_rebuilt: LEAST_REBUILT,
            inner_rounds: INNER_ROUNDS,
            times: 1,
            bound: 0,
            report: InsertReport {
                sub_constraints: sub_constraints.len() as u64,
                intersections: Some(0),
                ..InsertReport::default()
            },
        })
    }

    /// Another number of inner rounds to an outer one than [`INNER_ROUNDS`]. The number shows in which triangulation
    /// comes out, not in whether it has the constrained edges.
    pub fn set_inner_rounds(&mut self, rounds: u32) {
        self.inner_rounds = rounds.clamp(1, 1 << 20);
    }

    /// Another number of triangles of the longest chain that is rebuilt than [`LONGEST_REBUILT`], however few walk: with 0, all
    /// is done by flips, as \[QCT\] do.
    pub fn set_longest_rebuilt(&mut self, triangles: u32) {
        (self.longest_rebuilt, self.least_rebuilt) = (triangles, 0);
    }

    /// Rules other than the stage's own, for tests that show what the rules are for.
    #[doc(hidden)]
    pub fn set_trial(&mut self, trial: Trial) {
        self.inner.trial = trial;
    }

    /// Whether every sub-constraint is an edge.
    pub fn is_done(&self) -> bool {
        self.remaining == 0
    }

    /// What has been done so far.
    pub fn report(&self) -> InsertReport {
        self.report
    }

    /// The mesh as it is now.
    pub fn mesh(&self) -> &GhostMesh {
        self.mesh
    }

    /// One outer round with its inner rounds.
    ///
    /// # Errors
    ///
    /// As [`insert`].
    pub fn outer_round(&mut self) -> Result<(), ConstrainError> {
        let before = (self.report.all_flips(), self.remaining, self.partial_walks);
        self.mark()?;
        self.rebuild()?;
        let most = if self.waiting.is_empty() { self.bound } else { u64::from(self.inner_rounds * self.times) };
        for _ in 0..most {
            if self.inner_round()? == 0 {
                break;
            }
        }
        let stuck = before == (self.report.all_flips(), self.remaining, self.partial_walks);
        let rounds = self.report.outer_rounds;
        if self.remaining > 0 && (stuck || rounds >= self.bound) {
            return Err(ConstrainError::BoundExceeded { rounds, remaining: self.remaining });
        }
        Ok(())
    }

    /// Steps 1 to 3 of an outer round.
    ///
    /// # Errors
    ///
    /// As [`insert`].
    pub fn mark(&mut self) -> Result<(), ConstrainError> {
        // Step 1: all edges first, so that none is flipped away by a walk of this round.
        let mut walkers = Vec::with_capacity(self.waiting.len());
        for s in std::mem::take(&mut self.waiting) {
            if let Some(h) = self.depart(s)? {
                walkers.push((s, h));
            }
        }
        if self.report.outer_rounds == 0 {
            if walkers.len() < self.least_rebuilt as usize {
                self.longest_rebuilt = 0;
            }
            self.find_hubs(&mut walkers)?;
        }
        self.hold_pairs();
        for &(s, h) in &walkers {
            if self.hubs[s as usize].is_some() {
                self.own_first(s, h);
            }
        }
        walkers.retain(|&(s, h)| {
            let walks = self.hubs[s as usize].is_none() || place::owner(self.owner[(h / 3) as usize]) == Some(s);
            if !walks {
                self.lose(s);
            }
            walks
        });

        // Step 2.
        let (mut walked, mut long) = (0, Vec::new());
        for (s, h) in &mut walkers {
            let length = self.claim(*s, h)?;
            walked += length;
            long.extend((length > u64::from(self.longest_rebuilt)).then_some(*s as usize));
        }
        for s in long {
            self.by_flips[s] = true;
        }
        for t in std::mem::take(&mut self.marked) {
            if self.is_by_flips(t) {
                self.touch(t);
            }
        }
        self.report.walked += walked;
        if self.report.outer_rounds == 0 {
            self.report.intersections = self.hubs.iter().all(Option::is_none).then_some(walked);
        }
        let long = walked / (LONG_CHAIN * (walkers.len() as u64).max(1));
        let late = self.report.outer_rounds / USUAL_ROUNDS;
        self.times = MOST_TIMES.min(1 + u32::try_from(long.max(late)).unwrap_or(MOST_TIMES - 1));
        self.report.outer_rounds += 1;
        // No family of inputs is known to need a tenth of this: chains grow shorter side by side.
        self.bound = 64 + 8 * (self.report.walked + self.sub_constraints.len() as u64);
        // Step 3.
        walkers.retain(|&(s, _)| !self.lost[s as usize] && !self.by_flips[s as usize]);
        self.short = walkers;
        self.waiting.append(&mut self.losers);
        self.waiting.sort_unstable();
        for &s in &self.waiting {
            self.lost[s as usize] = false;
        }
        Ok(())
    }

    /// Whether the owner of a triangle goes by flips.
    pub(super) fn is_by_flips(&self, t: u32) -> bool {
        place::owner(self.owner[t as usize]).is_some_and(|s| self.by_flips[s as usize])
    }

    /// Step 4 of an outer round.
    ///
    /// # Errors
    ///
    /// [`ConstrainError::Lost`] if the mesh is no triangulation of a convex hull.
    pub fn rebuild(&mut self) -> Result<(), ConstrainError> {
        for (s, h) in std::mem::take(&mut self.short) {
            let slots = rebuild(self.mesh, self.positions, &self.owner, h, [&mut self.spokes, &mut self.degrees]);
            for t in slots.ok_or(ConstrainError::Lost { ends: self.sub_constraints[s as usize] })? {
                self.owner[t as usize] = FREE;
            }
            self.remaining -= 1;
            self.report.rebuilt += 1;
        }
        Ok(())
    }

    /// Where a sub-constraint leaves the star of one of its ends; none if it is an edge, and so done.
    fn depart(&mut self, s: u32) -> Result<Option<u32>, ConstrainError> {
        let ends = self.sub_constraints[s as usize];
        let [a, b] = ends.map(|v| self.degrees[v as usize]);
        let (end, hint) = self.hubs[s as usize].unwrap_or((usize::from(b < a), NONE));
        let (from, to) = (ends[end], ends[1 - end]);
        let spoke = self.spokes[from as usize];
        match depart_from(self.mesh, self.positions, hint, spoke, to) {
            Some(Departure::Across(h)) => {
                if let Some((_, hint)) = &mut self.hubs[s as usize] {
                    *hint = h;
                }
                Ok(Some(h))
            }
            Some(Departure::Along(h)) if self.mesh.destination(h) == to => {
                self.mesh.set_constrained(h, true);
                self.remaining -= 1;
                self.report.edges_already += u64::from(self.report.outer_rounds == 0);
                Ok(None)
            }
            Some(Departure::Along(h)) => {
                let vertex = self.mesh.destination(h);
                Err(ConstrainError::ThroughVertex { sub_constraint: ends, vertex })
            }
            None => Err(ConstrainError::Lost { ends }),
        }
    }

    /// Which vertices are hubs: those that end there begin there.
    fn find_hubs(&mut self, walkers: &mut [(u32, u32)]) -> Result<(), ConstrainError> {
        let mut counts = vec![0u32; self.positions.len()];
        for v in walkers.iter().flat_map(|&(s, _)| self.sub_constraints[s as usize]) {
            counts[v as usize] += 1;
        }
        for (s, h) in walkers {
            let ends = self.sub_constraints[*s as usize];
            let is_hub = |&v: &u32| counts[v as usize] >= HUB && self.degrees[v as usize] <= MOST_SPOKES;
            if let Some(end) = ends.iter().position(is_hub) {
                self.hubs[*s as usize] = Some((end, NONE));
                self.by_flips[*s as usize] = true;
                *h = self.depart(*s)?.ok_or(ConstrainError::Lost { ends })?;
            }
        }
        Ok(())
    }

    /// Claims the triangle in which a walk begins, by the half-edge opposite its end.
    fn own_first(&mut self, s: u32, h: u32) {
        let sign: Side = if self.mesh.apex(h) == self.sub_constraints[s as usize][1] { -1 } else { 1 };
        let (t, k) = twin_code(h);
        let mut sides = [0; 3];
        (sides[(k + 1) % 3], sides[(k + 2) % 3]) = (-sign, sign);
        self.own(s, t, sides);
    }

    /// The walk of one sub-constraint, from half-edge `first` opposite one of its ends; gives the length of its chain. `first`
    /// becomes the half-edge by which it leaves its lower end.
    fn claim(&mut self, s: u32, first: &mut u32) -> Result<u64, ConstrainError> {
        let h = *first;
        let ends = self.sub_constraints[s as usize];
        let reversed = self.mesh.apex(h) == ends[1];
        let line = if reversed { [ends[1], ends[0]] } else { ends }.map(|v| self.positions[v as usize]);
        // Sides are those of the line from the lower end to the higher one.
        let sign: Side = if reversed { -1 } else { 1 };
        let mut h = h;
        let most = if self.hubs[s as usize].is_some() { hub_walk(self.walks[s as usize]) } else { u64::MAX };
        self.walks[s as usize] += 1;
        // The side of the corner off the edge by which the triangle is left.
        let mut near = 0;
        for length in 1..self.mesh.slots() as u64 {
            // Right of the line lies the origin of h, left of it the destination.
            let (t, k) = twin_code(h);
            let mut sides = [0; 3];
            (sides[k], sides[(k + 1) % 3], sides[(k + 2) % 3]) = (sign * near, -sign, sign);
            self.own(s, t, sides);
            if length == most {
                self.partial_walks += 1;
                self.lose(s);
                return Ok(length);
            }
            if self.mesh.is_constrained(h) {
                return Err(self.blocked(s, h));
            }
            let Some((g, side)) = enter(self.mesh, self.positions, h, line) else {
                return Err(ConstrainError::Lost { ends });
            };
            if side == Sign::Zero {
                let vertex = self.mesh.apex(g);
                if vertex != ends[usize::from(!reversed)] {
                    return Err(ConstrainError::ThroughVertex { sub_constraint: ends, vertex });
                }
                let (t, k) = twin_code(g);
                (sides[k], sides[(k + 1) % 3], sides[(k + 2) % 3]) = (0, sign, -sign);
                self.own(s, t, sides);
                *first = if reversed { g } else { *first };
                return Ok(length + 1);
            }
            h = leave(g, side);
            near = side as Side;
        }
        Err(ConstrainError::Lost { ends })
    }

    /// A sub-constraint crosses a constrained edge.
    pub(super) fn blocked(&self, s: u32, h: u32) -> ConstrainError {
        let mut edge = [self.mesh.origin(h), self.mesh.destination(h)];
        edge.sort_unstable();
        ConstrainError::Blocked { sub_constraint: self.sub_constraints[s as usize], edge }
    }

    fn lose(&mut self, s: u32) {
        if !std::mem::replace(&mut self.lost[s as usize], true) {
            self.losers.push(s);
        }
    }

    fn own(&mut self, s: u32, t: usize, sides: [Side; 3]) {
        let word = place::word(s, sides);
        let before = place::owner(self.owner[t]);
        if before == Some(s) {
            if !self.by_flips[s as usize] {
                // Should the chain be too long by now, it was not looked at before.
                self.marked.push(t as u32);
            }
            return;
        }
        if word > self.owner[t] {
            self.lose(s);
            return;
        }
        if let Some(owner) = before {
            self.lose(owner);
        }
        self.owner[t] = word;
        self.marked.push(t as u32);
    }
}
