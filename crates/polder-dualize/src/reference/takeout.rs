//! Taking vertices out of a triangulation. [QCT] section 3.3, Algorithm 2.
//!
//! In rounds, until no pinned vertex is left:
//!
//! 1. Of the pinned vertices, those that have no pinned neighbor of lower priority are taken out now. No two of them
//!    are neighbors, so their stars share no triangle.
//! 2. A vertex inside: cut ears off its star until three neighbors are left, then replace the three triangles by one.
//!    Cutting an ear is a flip of the edge to its tip, which goes from the star to the two neighbors beside it.
//! 3. A vertex on the hull: its triangles become ghost triangles of the edges across, as if it were moved to infinity.
//! 4. Ghost flips until the hull is convex again.
//!
//! A pinned vertex counts at its pixel center, like its pinned neighbors: that is where the triangulation is valid.
//!
//! # Ears
//!
//! A neighbor `l` between the neighbors `a` and `b` is an ear if `a l b` is strictly counterclockwise and the vertex
//! does not lie right of the diagonal from `a` to `b`; it may lie *on* it. To demand that it lie strictly left gets
//! stuck on lattices, where a vertex with four neighbors lies on both diagonals. The ear's triangle lies in the angle
//! in which the vertex sees it, and so it holds no other neighbor, and what remains is again a star around the vertex,
//! or has it on the cut edge.
//!
//! While more than three neighbors remain there is an ear. The star is a simple polygon, so it has two ears, in the
//! usual sense, that do not overlap and whose tips are not the two ends of the cut edge the vertex lies on, if it lies
//! on one. At most one of them can have the vertex inside; the vertex sees the tip of the other beyond its diagonal,
//! which is what is demanded. With three left, the last triangle is counterclockwise for the same reason.
//!
//! The search walks around the star like Graham's scan: one step back after a cut, one step on otherwise. Whatever
//! lies behind has been found to be no ear as it stands, so a star of `m` neighbors takes at most `3 m` steps, however
//! large it is, and no memory. [`take_out`] starts it at the star's lowest half-edge, so that the outcome depends on
//! nothing but the mesh.
//!
//! # The hull
//!
//! With a hull vertex gone, the edges across its star are hull edges. Seen from where it was, they are a chain with
//! ascending angles, and both ends of the chain turn left, since each has lost a triangle. So ghost flips concern the
//! chain alone, and what they add lies in what was the star. Several neighbors of one vertex may go in one round: their
//! stars do not overlap.
//!
//! On a chain, a vertex is merged into one next to it: the two ghost triangles of the edge between them vanish. When fewer than three vertices that are not on a line remain, the mesh is therefore a chain, or empty
//! when fewer than two remain, and it is the next stage that goes on from there.
//!
//! # Heirs
//!
//! A vertex leaves an heir, from which later searches for it start: the first neighbor around it that is not pinned, or
//! else the first one. An heir may go as well, in a later round; its own heir then serves.

use super::star::{broken, star};
use crate::DualizeError;
use glam::DVec2;
use polder_flip::reference::close_hull;
use polder_flip::{FlipReport, priority};
use polder_mesh::{DELETED, GHOST, GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, orient2d};

const STAGE: &str = "take out";

/// What [`take_out`] did beside changing the mesh.
pub(super) struct Taken {
    /// For each vertex itself if it is still there, else its heir, or [`NONE`] if the mesh is empty.
    pub(super) heirs: Vec<u32>,
    pub(super) rounds: u64,
    pub(super) hull: FlipReport,
}

/// Takes the pinned vertices out and closes the ranks: no slot of the mesh stays free.
///
/// The mesh must be a triangulation of the positions `at` with a convex hull, or a chain, or empty.
pub(super) fn take_out(mesh: &mut GhostMesh, at: &[DVec2], mut pinned: Vec<bool>) -> Result<Taken, DualizeError> {
    let mut heirs: Vec<u32> = (0..at.len() as u32).collect();
    let mut gone = Vec::new();
    let mut left = pinned.iter().filter(|&&p| p).count();
    let bound = left as u64;
    let mut rounds = 0;
    let mut hull = FlipReport::default();
    while left > 0 && mesh.triangles.iter().any(|t| t[0] != DELETED) {
        if rounds == bound {
            return Err(DualizeError::BoundExceeded { stage: STAGE, bound });
        }
        rounds += 1;
        let before = gone.len();
        for (v, h) in winners(mesh, &pinned) {
            heirs[v as usize] = heir(mesh, h, &pinned);
            remove(mesh, at, h)?;
            gone.push(v);
        }
        gone[before..].iter().for_each(|&v: &u32| pinned[v as usize] = false);
        left -= gone.len() - before;
        hull += close_hull(mesh, at)?;
    }
    // An heir went later than the vertex that named it, so from the last one back each heir is final when it is read.
    for &v in gone.iter().rev() {
        let heir = heirs[v as usize];
        heirs[v as usize] = heirs.get(heir as usize).copied().unwrap_or(NONE);
    }
    mesh.compact();
    if mesh.slots() == 0 {
        heirs.fill(NONE);
    }
    Ok(Taken { heirs, rounds, hull })
}

/// Step 1: the vertices of this round, ascending, each with the lowest half-edge out of it.
fn winners(mesh: &GhostMesh, pinned: &[bool]) -> Vec<(u32, u32)> {
    let is_pinned = |v: u32| pinned.get(v as usize).is_some_and(|&p| p);
    let mut first = vec![NONE; pinned.len()];
    let mut beaten = vec![false; pinned.len()];
    for h in 0..3 * mesh.slots() as u32 {
        let v = mesh.origin(h);
        if is_pinned(v) {
            first[v as usize] = first[v as usize].min(h);
            let u = mesh.destination(h);
            if is_pinned(u) {
                beaten[if priority(u) < priority(v) { v } else { u } as usize] = true;
            }
        }
    }
    let free = |&v: &u32| first[v as usize] != NONE && !beaten[v as usize];
    (0..pinned.len() as u32).filter(free).map(|v| (v, first[v as usize])).collect()
}

fn heir(mesh: &GhostMesh, h: u32, pinned: &[bool]) -> u32 {
    let mut neighbors = star(mesh, h).map(|h| mesh.destination(h)).filter(|&u| u != GHOST);
    let first = neighbors.next().unwrap_or(NONE);
    let free = std::iter::once(first).chain(neighbors).find(|&u| pinned.get(u as usize) == Some(&false));
    free.unwrap_or(first)
}

/// Takes out the origin of `h`.
fn remove(mesh: &mut GhostMesh, at: &[DVec2], h: u32) -> Result<(), DualizeError> {
    let v = mesh.origin(h);
    let (mut degree, mut ghosts, mut to_ghost, mut to_finite) = (0, 0, NONE, NONE);
    for g in star(mesh, h) {
        degree += 1;
        if mesh.destination(g) == GHOST {
            ghosts += 1;
            to_ghost = g;
        } else {
            to_finite = g;
        }
    }
    match (ghosts, degree) {
        (0, 3..) => return remove_inner(mesh, at, h, degree),
        (1, 3..) => contract(mesh, to_ghost),
        (2, 4) | (1, 2) => contract(mesh, to_finite),
        _ => return Err(broken(STAGE, v)),
    }
    Ok(())
}

/// Step 2, for a vertex of so many neighbors, none of them the ghost.
fn remove_inner(mesh: &mut GhostMesh, at: &[DVec2], start: u32, degree: usize) -> Result<(), DualizeError> {
    let v = mesh.origin(start);
    let (mut h, mut left, mut steps) = (start, degree, 0);
    while left > 3 {
        if steps == 4 * degree {
            return Err(broken(STAGE, v));
        }
        steps += 1;
        let (l, b, a) = (mesh.destination(h), mesh.apex(h), mesh.apex(mesh.twin(h)));
        let [l, a, b, p] = [l, a, b, v].map(|u| at[u as usize]);
        if orient2d(a, l, b) == Sign::Positive && orient2d(a, b, p) != Sign::Negative {
            // The flip leaves h in the star: it now leads to the neighbor before, one step back.
            mesh.flip(h);
            left -= 1;
        } else {
            h = mesh.rotate_ccw(h);
        }
    }
    let out = [h, mesh.rotate_ccw(h), mesh.rotate_cw(h)];
    let [t, u, w] = out.map(|h| h / 3);
    let across = out.map(next);
    let corners = across.map(|g| mesh.origin(g));
    let twins = across.map(|g| mesh.twin(g));
    // The new triangle's edge from corner i to corner i + 1 is edge i + 2.
    mesh.triangles[t as usize] = corners;
    for (i, &twin) in twins.iter().enumerate() {
        mesh.link(3 * t + (i as u32 + 2) % 3, twin);
    }
    mesh.delete(u as usize);
    mesh.delete(w as usize);
    Ok(())
}

/// Shrinks the edge `h` to its destination: its two triangles vanish, the other triangles around its origin stay.
///
/// The other two edges of a vanishing triangle become one. At an end of a chain, that is an end of `h`, the two
/// triangles share one more edge, which vanishes as well.
fn contract(mesh: &mut GhostMesh, h: u32) {
    let (from, to, g) = (mesh.origin(h), mesh.destination(h), mesh.twin(h));
    for out in star(mesh, h).collect::<Vec<u32>>() {
        for corner in &mut mesh.triangles[(out / 3) as usize] {
            if *corner == from {
                *corner = to;
            }
        }
    }
    let beyond = [next(h), prev(h), next(g), prev(g)].map(|side| mesh.twin(side));
    let (end_at_to, end_at_from) = (beyond[0] == prev(g), beyond[1] == next(g));
    match (end_at_to, end_at_from) {
        (false, false) => {
            mesh.link(beyond[0], beyond[1]);
            mesh.link(beyond[2], beyond[3]);
        }
        (true, false) => mesh.link(beyond[1], beyond[2]),
        (false, true) => mesh.link(beyond[0], beyond[3]),
        (true, true) => {}
    }
    mesh.delete((h / 3) as usize);
    mesh.delete((g / 3) as usize);
}
