//! Stage 4: the points that are not vertices yet. [QCT] section 3.4, Algorithm 3.
//!
//! In rounds, until no point is left:
//!
//! 1. Find the *container* of each point by a straight walk (module `locate`): the finite triangle that it lies
//!    in, the two triangles of the edge that it lies on, or outside the hull the ghost triangle of its sector (module
//!    `sector`). A point on a vertex is a duplicate of it, and done.
//! 2. Each point claims its container with its key (module `key`); the least key gets a triangle. Points on edges go
//!    first, since they need two triangles, then those nearest to the container's center, or highest above the hull.
//! 3. A point that got all it claimed is inserted; the new triangles of the point of rank `r` in this round, counted
//!    among its winners in the order of the points, are the two slots after the last one and `2 r` more.
//! 4. Ghost flips until the hull is convex again.
//! 5. One round of flips, over what is new and what the last round of flips left. The other points keep their container
//!    as the place from which the next walk starts.
//!
//! The least key of all always gets what it claims, so each round inserts a point. Where many points crowd in one
//! triangle, the one nearest to its center splits it evenly, and the flip round keeps the parts from becoming slivers:
//! without it points in a cluster flip several times as often later, and flipping to the end in each round gains
//! nothing more.
//!
//! A mesh without finite triangles is given some first (module `bootstrap`).
//!
//! Departures: [QCT] lets the lowest index win; inserts into a polygon of fake points that holds all others, so that
//! nothing is outside; and does not say how it walks.

use super::bootstrap::{Start, bootstrap};
use super::certify::certify;
use super::graft::{into_edge, into_triangle};
use super::key::Key;
use super::locate::{Place, Walk};
use super::sector::{Center, sector};
use super::star::broken;
use crate::{DualizeError, Inserted};
use glam::DVec2;
use polder_flip::FlipReport;
use polder_flip::reference::{Active, flip_round, round_bound};
use polder_mesh::{GHOST, GhostMesh, NONE, prev};

const STAGE: &str = "insert";

/// A point to be inserted, and a half-edge of the triangle from which the next walk to it starts.
#[derive(Clone, Copy)]
struct Waiting {
    point: u32,
    from: u32,
}

/// Where a point belongs: a triangle, or the two triangles of an edge.
#[derive(Clone, Copy)]
enum Container {
    Triangle(u32),
    Edge(u32),
}

/// Inserts `points` into a triangulation.
///
/// `mesh` is a triangulation of some of `positions` with a convex hull, or a chain, or empty; `points` are others of
/// them, each with a vertex in `starts` from which the search for it starts. A start that is no vertex of the mesh, such
/// as [`NONE`], means anywhere. Every position must be a vertex or among `points`: from an empty mesh, all of
/// them. No position at all gives the empty mesh.
///
/// # Errors
///
/// [`DualizeError::Mismatch`] if `points` and `starts` differ in length or name a point without a position. Every other
/// error means that the mesh was not a triangulation as above.
pub fn insert(mesh: GhostMesh, positions: &[DVec2], points: &[u32], starts: &[u32]) -> Result<Inserted, DualizeError> {
    let mut mesh = mesh;
    mesh.compact();
    check(&mesh, positions, points, starts)?;
    let mut out = Inserted { vertex_of: (0..positions.len() as u32).collect(), ..Inserted::default() };
    if positions.is_empty() {
        return Ok(out);
    }
    out.mesh = if mesh.finite().next().is_some() {
        mesh
    } else {
        out.bootstrapped = true;
        match bootstrap(mesh, positions) {
            Start::Mesh(mesh) => mesh,
            Start::Line(mesh, vertex_of) => {
                out.duplicates = vertex_of.iter().enumerate().filter(|(i, v)| *i != **v as usize).count() as u64;
                (out.mesh, out.vertex_of) = (mesh, vertex_of);
                certify(&out.mesh, positions, STAGE)?;
                return Ok(out);
            }
        }
    };

    let center = Center::of(&out.mesh, positions).ok_or_else(|| broken(STAGE, GHOST))?;
    let anywhere = out.mesh.finite().next().map_or(NONE, |t| 3 * t as u32);
    let half_edges = out.mesh.half_edge_of_vertex(positions.len());
    let from = |v: u32| half_edges.get(v as usize).copied().filter(|&h| h != NONE).unwrap_or(anywhere);
    let mut waiting: Vec<Waiting> =
        points.iter().zip(starts).map(|(&point, &start)| Waiting { point, from: from(start) }).collect();
    let mut round = Round { claims: vec![u64::MAX; out.mesh.slots()], active: Active::new(), positions, center };
    let bound = waiting.len() as u64;
    while !waiting.is_empty() {
        if out.rounds == bound {
            return Err(DualizeError::BoundExceeded { stage: STAGE, bound });
        }
        out.rounds += 1;
        waiting = round.run(&mut out, waiting)?;
    }
    certify(&out.mesh, positions, STAGE)?;
    Ok(out)
}

/// What rounds need beside the mesh.
struct Round<'a> {
    positions: &'a [DVec2],
    center: Center,
    /// For each triangle the least key that claims it, all ones between rounds.
    claims: Vec<u64>,
    active: Active,
}

impl Round<'_> {
    /// One round; returns the points still waiting.
    fn run(&mut self, out: &mut Inserted, waiting: Vec<Waiting>) -> Result<Vec<Waiting>, DualizeError> {
        let (claimants, containers) = self.locate(out, waiting)?;
        // Step 2.
        let keys: Vec<u64> = claimants.iter().zip(&containers).map(|(w, &c)| self.key(&out.mesh, w.point, c)).collect();
        for (&container, &key) in containers.iter().zip(&keys) {
            for t in triangles(&out.mesh, container) {
                let claim = &mut self.claims[t as usize];
                *claim = (*claim).min(key);
            }
        }
        let won: Vec<bool> = containers
            .iter()
            .zip(&keys)
            .map(|(&container, &key)| triangles(&out.mesh, container).all(|t| self.claims[t as usize] == key))
            .collect();
        for &container in &containers {
            for t in triangles(&out.mesh, container) {
                self.claims[t as usize] = u64::MAX;
            }
        }

        // Step 3. A container's slot still holds a triangle next to it afterwards: a loser's next walk starts there.
        let first = out.mesh.slots() as u32;
        let winners = won.iter().filter(|&&won| won).count();
        grow(&mut out.mesh, 2 * winners);
        self.claims.resize(out.mesh.slots(), u64::MAX);
        let mut hull = Active::hull(&GhostMesh::default());
        let mut later = Vec::with_capacity(won.len() - winners);
        let mut rank = 0;
        for ((claimant, &container), &won) in claimants.iter().zip(&containers).zip(&won) {
            if won {
                self.graft(&mut out.mesh, claimant.point, container, first + 2 * rank, &mut hull);
                rank += 1;
            } else {
                let from = match container {
                    Container::Edge(h) => h,
                    Container::Triangle(t) => 3 * t,
                };
                later.push(Waiting { point: claimant.point, from });
            }
        }
        out.inserted += winners as u64;

        // Steps 4 and 5.
        out.hull += self.close(&mut out.mesh, hull)?;
        let tests = self.active.tests();
        let flips = flip_round(&mut out.mesh, self.positions, &mut self.active);
        out.flips += FlipReport { rounds: 1, flips, tests: self.active.tests() - tests };
        Ok(later)
    }

    /// Step 1: the points that are not duplicates, and their containers.
    fn locate(
        &self,
        out: &mut Inserted,
        waiting: Vec<Waiting>,
    ) -> Result<(Vec<Waiting>, Vec<Container>), DualizeError> {
        let mut walk = Walk { mesh: &out.mesh, positions: self.positions, steps: 0 };
        let mut claimants = Vec::with_capacity(waiting.len());
        let mut containers = Vec::with_capacity(waiting.len());
        for w in waiting {
            let container = match walk.locate(w.point, w.from)? {
                Place::Vertex(v) => {
                    out.vertex_of[w.point as usize] = v;
                    out.duplicates += u64::from(v != w.point);
                    continue;
                }
                Place::Inside(t) => Container::Triangle(t),
                Place::Edge(h) => Container::Edge(h),
                Place::Outside(ghost) => {
                    let p = self.positions[w.point as usize];
                    let ghost = sector(&out.mesh, self.positions, &self.center, p, ghost, &mut out.sector_steps)?;
                    Container::Triangle(ghost)
                }
            };
            claimants.push(w);
            containers.push(container);
        }
        out.steps += walk.steps;
        Ok((claimants, containers))
    }

    fn key(&self, mesh: &GhostMesh, point: u32, container: Container) -> u64 {
        let at = |v: u32| self.positions[v as usize];
        let p = at(point);
        match container {
            Container::Edge(h) => Key::on_edge(p, [mesh.origin(h), mesh.destination(h)].map(at)),
            Container::Triangle(t) => match mesh.triangles[t as usize] {
                // The hull edge from u to w.
                [GHOST, w, u] | [u, GHOST, w] | [w, u, GHOST] => Key::outside(p, [u, w].map(at)),
                corners => Key::inside(p, corners.map(at)),
            },
        }
        .of(point)
    }

    /// Inserts one point, and lists the edges around it for this round's flips.
    fn graft(&mut self, mesh: &mut GhostMesh, point: u32, container: Container, slot: u32, hull: &mut Active) {
        let new = match container {
            Container::Triangle(t) => {
                into_triangle(mesh, t, point, slot);
                [3 * t + 2, 3 * slot + 2, 3 * slot + 5].iter().for_each(|&h| self.active.push(h));
                [t, slot, slot + 1, t]
            }
            Container::Edge(h) => {
                let g = mesh.twin(h);
                into_edge(mesh, h, point, slot);
                [prev(h), prev(g), 3 * slot + 1, 3 * slot + 4].iter().for_each(|&h| self.active.push(h));
                [h / 3, g / 3, slot, slot + 1]
            }
        };
        for t in new {
            if mesh.is_ghost(t as usize) {
                hull.push_triangle(t as usize);
            }
        }
    }

    /// Step 4. The edges around the ghost flips are new as well.
    fn close(&mut self, mesh: &mut GhostMesh, mut hull: Active) -> Result<FlipReport, DualizeError> {
        let mut report = FlipReport::default();
        let bound = round_bound(mesh.slots());
        while !hull.is_empty() {
            if report.rounds == bound {
                return Err(DualizeError::BoundExceeded { stage: "insert, close hull", bound });
            }
            report.rounds += 1;
            report.flips += flip_round(mesh, self.positions, &mut hull);
            hull.half_edges().iter().for_each(|&h| self.active.push(h));
        }
        report.tests = hull.tests();
        Ok(report)
    }
}

fn triangles(mesh: &GhostMesh, container: Container) -> impl Iterator<Item = u32> {
    let (first, second) = match container {
        Container::Triangle(t) => (t, None),
        Container::Edge(h) => (h / 3, Some(mesh.twin(h) / 3)),
    };
    std::iter::once(first).chain(second)
}

fn grow(mesh: &mut GhostMesh, by: usize) {
    let mut free = GhostMesh::with_slots(by);
    mesh.triangles.append(&mut free.triangles);
    mesh.links.append(&mut free.links);
    mesh.constrained.append(&mut free.constrained);
}

fn check(mesh: &GhostMesh, positions: &[DVec2], points: &[u32], starts: &[u32]) -> Result<(), DualizeError> {
    let mismatch = |what, index| Err(DualizeError::Mismatch { what, index });
    if points.len() != starts.len() {
        return mismatch("points and starts that differ in number", points.len().min(starts.len()));
    }
    if let Some(index) = points.iter().position(|&i| i as usize >= positions.len()) {
        return mismatch("a point without a position", index);
    }
    let corners = mesh.triangles.as_flattened();
    match corners.iter().position(|&v| v != GHOST && v as usize >= positions.len()) {
        Some(index) => mismatch("a corner without a position", index / 3),
        None => Ok(()),
    }
}
