//! Stage 4: the points that are not vertices yet. [QCT] section 3.4, Algorithm 3.
//!
//! In rounds, until no point is left:
//!
//! 1. Find the *container* of each point by a straight walk (module `locate`): the finite triangle that it lies
//!    in, the two triangles of the edge that it lies on, or outside the hull the ghost triangle of its sector (module
//!    `sector`). A point on a vertex is a duplicate of it, and done.
//! 2. Each point claims its container with its key (module `key`); the least key gets a triangle. Points on edges go
//!    first, since they need two triangles; in a triangle chance decides, outside it is the point highest above the hull.
//! 3. A point that got all it claimed is inserted. The two triangles more that there are then go to the two slots that the
//!    point brings along: so each slot is known beforehand, and nobody has to count.
//! 4. If at least a sixteenth as many points still wait as were inserted, one round of flips, of edges around new vertices
//!    alone.
//! 5. Ghost flips until the hull is convex again. The other points keep their container as the place from which the next
//!    walk starts.
//! 6. Once the mesh has fallen behind ([`insert_turn`]): flips of all edges until none is illegal, and from then on the same
//!    of the edges around new vertices after each round, if step 4 had made flips, and after step 5.
//!
//! The least key of all always gets what it claims, so each round inserts a point. Where many points crowd in one
//! triangle, a random one leaves a fraction of them in each part, so that rounds go with the logarithm of their number;
//! and the flip rounds keep the parts from becoming slivers. Of the edges around new vertices more than half are illegal;
//! those around the flips are mostly not, and are left to stage 5, which has to test all edges anyway: testing them as well,
//! twice as many, saved no flip. Nor does flipping to the end in each round, or when few points wait.
//!
//! All that is so as long as the mesh stays near Delaunay. On concentric circles, beside a line, or where magnitudes have
//! nothing in common it does not: slivers take in points and make longer slivers, and the flips of stage 5 become quadratic
//! in the number of points. It shows in the edges around new vertices: fewer than half of them are illegal, and fewer from
//! round to round. A million points on four concentric circles take 268 million flips by steps 1 to 5, and less than 6
//! million with step 6.
//!
//! A mesh without finite triangles is given some first (module `bootstrap`).
//!
//! Departures: [QCT] lets the lowest index win; inserts into a polygon of fake points that holds all others, so that
//! nothing is outside; and does not say how it walks.

use super::bootstrap::{Start, bootstrap};
use super::certify::certify;
use super::kernels::insert::{
    BEHIND, Located, WON, insert_begin, insert_claim, insert_graft, insert_locate, insert_relink, insert_turn,
    insert_wait,
};
use super::sector::Center;
use super::star::broken;
use crate::{DualizeError, Inserted};
use glam::DVec2;
use polder_flip::FlipReport;
use polder_flip::reference::{Active, flip_round, round_bound};
use polder_mesh::{Cancelled, DELETED, GHOST, GhostMesh, NONE};

const STAGE: &str = "insert";

/// The points that a mesh lacks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToInsert {
    /// The points.
    pub points: Vec<u32>,
    /// For each a vertex from which the search for it starts. What is no vertex of the mesh, such as [`NONE`], means
    /// anywhere.
    pub starts: Vec<u32>,
    /// For each two slots of the mesh, free or behind its end, that nobody else has. If the mesh is empty, one point has
    /// none: twice [`NONE`].
    pub slots: Vec<[u32; 2]>,
}

impl ToInsert {
    /// Points and starts, with the free slots of the mesh in ascending order, two for each, and then those behind its end.
    pub fn into_free_slots(mesh: &GhostMesh, points: Vec<u32>, starts: Vec<u32>) -> Self {
        let mut free = (0..mesh.slots()).filter(|&t| mesh.is_deleted(t)).chain(mesh.slots()..).map(|t| t as u32);
        let none = if mesh.slots() == 0 { 1.min(points.len()) } else { 0 };
        let pair = |r: usize| if r < none { [NONE; 2] } else { [free.next(), free.next()].map(|t| t.unwrap_or(NONE)) };
        let slots = (0..points.len()).map(pair).collect();
        Self { points, starts, slots }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// Inserts points into a triangulation.
///
/// `mesh` is a triangulation of some of `positions` with a convex hull, or a chain, or empty; the points are all others
/// of them. No position at all gives the empty mesh. A point that equals a vertex leaves its slots free.
///
/// # Errors
///
/// [`DualizeError::Mismatch`] if the parts of `new` differ in length, name a point without a position, or slots that
/// are not free. Every other error means that the mesh was not a triangulation as above.
pub fn insert(mesh: GhostMesh, positions: &[DVec2], new: &ToInsert) -> Result<Inserted, DualizeError> {
    insert_with(mesh, positions, new, &mut || Ok(()))
}

/// The same, asking before each round whether to go on.
///
/// # Errors
///
/// As [`insert`], and [`DualizeError::Cancelled`].
pub fn insert_with(
    mut mesh: GhostMesh,
    positions: &[DVec2],
    new: &ToInsert,
    go_on: &mut dyn FnMut() -> Result<(), Cancelled>,
) -> Result<Inserted, DualizeError> {
    let mut slots = check(&mesh, positions, new)?;
    let mut out = Inserted { vertex_of: (0..positions.len() as u32).collect(), ..Inserted::default() };
    if positions.is_empty() {
        return Ok(out);
    }
    let end = slots.iter().flatten().filter(|&&t| t != NONE).max().map_or(0, |&t| t as usize + 1);
    grow(&mut mesh, end);
    out.mesh = if mesh.finite().next().is_some() {
        mesh
    } else {
        out.bootstrapped = true;
        match bootstrap(mesh, positions, &mut slots) {
            Start::Mesh(mesh) => mesh,
            Start::Line(mesh, vertex_of) => {
                out.duplicates = vertex_of.iter().enumerate().filter(|(i, v)| *i != **v as usize).count() as u64;
                (out.mesh, out.vertex_of) = (mesh, vertex_of);
                certify(&out.mesh, positions, STAGE)?;
                return Ok(out);
            }
        }
    };

    let begun = insert_begin(&out.mesh, positions.len());
    let center = Center::of(&out.mesh, positions).ok_or_else(|| broken(STAGE, GHOST))?;
    let mut waiting = insert_wait(&begun, &new.points, &new.starts);
    let claims = vec![[NONE; 3]; out.mesh.slots()];
    let mut round = Round { claims, active: Active::new(), behind: 0, positions, slots: &slots, center };
    let bound = waiting.len() as u64;
    while !waiting.is_empty() {
        go_on()?;
        if out.rounds == bound {
            return Err(DualizeError::BoundExceeded { stage: STAGE, bound });
        }
        out.rounds += 1;
        waiting = round.run(&mut out, &waiting)?;
    }
    certify(&out.mesh, positions, STAGE)?;
    Ok(out)
}

/// What rounds need beside the mesh.
struct Round<'a> {
    positions: &'a [DVec2],
    /// The two slots of each point that has some.
    slots: &'a [[u32; 2]],
    center: Center,
    /// For each slot, what the kernels note there.
    claims: Vec<[u32; 3]>,
    active: Active,
    /// Rounds in a row in which the mesh seemed to fall behind; from [`BEHIND`] on it counts as behind for good.
    behind: u32,
}

impl Round<'_> {
    /// One round; returns the points still waiting.
    fn run(&mut self, out: &mut Inserted, waiting: &[[u32; 2]]) -> Result<Vec<[u32; 2]>, DualizeError> {
        let Self { slots, claims, .. } = self;
        let (mesh, round) = (&mut out.mesh, out.rounds as u32);
        // Step 1.
        let Located { mut places, on_vertices, steps } =
            insert_locate(mesh, self.positions, self.center.0, waiting, claims)?;
        out.steps += steps[0];
        out.sector_steps += steps[1];
        for [point, v] in on_vertices {
            out.vertex_of[point as usize] = v;
            out.duplicates += u64::from(v != point);
        }
        // Steps 2 and 3.
        insert_claim(mesh, waiting, &mut places, claims);
        let later = insert_graft(mesh, slots, waiting, &mut places, claims, round);
        let winners = places.iter().filter(|[place, _]| *place != NONE && place & WON != 0).count();
        out.inserted += winners as u64;
        let flips = later.len() >= winners.div_ceil(16);
        let [edges, ghosts] = insert_relink(mesh, slots, waiting, &places, claims, round, flips);
        edges.iter().for_each(|&h| self.active.push(h));

        let mut hull = Active::hull(&GhostMesh::default());
        ghosts.iter().for_each(|&h| hull.push(h));
        if self.behind >= BEHIND {
            // Step 6.
            out.hull += self.close(&mut out.mesh, hull)?;
            out.flips += self.flip(&mut out.mesh)?;
            return Ok(later);
        }
        // Steps 4 and 5.
        let mut tested = [0; 2];
        if !self.active.is_empty() {
            let tests = self.active.tests();
            let flips = flip_round(&mut out.mesh, self.positions, &mut self.active);
            out.flips += FlipReport { rounds: 1, flips, tests: self.active.tests() - tests };
            tested = [edges.len() as u32, self.active.illegal() as u32];
            self.active.clear();
        }
        out.hull += self.close(&mut out.mesh, hull)?;
        self.behind = insert_turn(self.behind, tested, later.len() as u32, out.inserted as u32);
        if self.behind >= BEHIND {
            self.active = Active::all(&out.mesh);
            out.flips += self.flip(&mut out.mesh)?;
        }
        Ok(later)
    }

    /// Step 6.
    fn flip(&mut self, mesh: &mut GhostMesh) -> Result<FlipReport, DualizeError> {
        let mut report = FlipReport::default();
        let (bound, tests) = (round_bound(mesh.slots()), self.active.tests());
        while !self.active.is_empty() {
            if report.rounds == bound {
                return Err(DualizeError::BoundExceeded { stage: "insert, flip", bound });
            }
            report.rounds += 1;
            report.flips += flip_round(mesh, self.positions, &mut self.active);
        }
        report.tests = self.active.tests() - tests;
        Ok(report)
    }

    /// Step 5.
    fn close(&self, mesh: &mut GhostMesh, mut hull: Active) -> Result<FlipReport, DualizeError> {
        let mut report = FlipReport::default();
        let bound = round_bound(mesh.slots());
        while !hull.is_empty() {
            if report.rounds == bound {
                return Err(DualizeError::BoundExceeded { stage: "insert, close hull", bound });
            }
            report.rounds += 1;
            report.flips += flip_round(mesh, self.positions, &mut hull);
        }
        report.tests = hull.tests();
        Ok(report)
    }
}

/// Free slots up to so many in all.
fn grow(mesh: &mut GhostMesh, slots: usize) {
    let mut free = GhostMesh::with_slots(slots.saturating_sub(mesh.slots()));
    mesh.triangles.append(&mut free.triangles);
    mesh.links.append(&mut free.links);
    mesh.constrained.append(&mut free.constrained);
}

/// The slots of each point that has some.
fn check(mesh: &GhostMesh, positions: &[DVec2], new: &ToInsert) -> Result<Vec<[u32; 2]>, DualizeError> {
    let mismatch = |what, index| Err(DualizeError::Mismatch { what, index });
    let (count, starts, pairs) = (new.points.len(), new.starts.len(), new.slots.len());
    if count != starts || count != pairs {
        return mismatch("points, starts and slots that differ in number", count.min(starts).min(pairs));
    }
    if let Some(index) = new.points.iter().position(|&i| i as usize >= positions.len()) {
        return mismatch("a point without a position", index);
    }
    let corners = mesh.triangles.as_flattened();
    if let Some(index) = corners.iter().position(|&v| v < DELETED && v as usize >= positions.len()) {
        return mismatch("a corner without a position", index / 3);
    }
    let mut taken: Vec<bool> = (0..mesh.slots()).map(|t| !mesh.is_deleted(t)).collect();
    taken.resize(mesh.slots().max(2 * positions.len()), false);
    let mut slots = vec![[NONE; 2]; positions.len()];
    let mut without = usize::from(!taken.contains(&true));
    for (index, (&point, &pair)) in new.points.iter().zip(&new.slots).enumerate() {
        if pair == [NONE; 2] && without > 0 {
            without -= 1;
        } else if pair.iter().any(|&t| taken.get_mut(t as usize).is_none_or(|taken| std::mem::replace(taken, true))) {
            return mismatch("slots that are not free", index);
        }
        slots[point as usize] = pair;
    }
    Ok(slots)
}
