//! Taking vertices out of a triangulation. [QCT] section 3.3, Algorithm 2.
//!
//! In rounds, until no pinned vertex is left:
//!
//! 1. Of the pinned vertices, those that have no pinned neighbor of lower priority are taken out now; then, of those with
//!    no such neighbor, the ones that have no other of lower priority. No two of all these are neighbors, so their stars
//!    share no triangle.
//! 2. A vertex leaves an *heir*, from which later searches for it start: the lowest of its neighbors that are not pinned,
//!    or the lowest of all.
//! 3. A vertex inside: cut ears off its star until three neighbors are left, then merge the three triangles into one.
//!    Cutting an ear is a flip of the edge to its tip, which goes from the star to the two neighbors beside it.
//! 4. A vertex on the hull: cut ears off its star, between its two neighbors on the hull, until there is none. Then move
//!    it to infinity: its finite triangles become ghost triangles, its two ghost triangles vanish.
//!
//! With the second turn of step 1 thin rings take 13 rounds; without it 33.
//!
//! A pinned vertex counts at its pixel center, like its pinned neighbors: that is where the triangulation is valid.
//!
//! Each vertex frees two slots of the mesh, and they stay free. The dualized mesh of `s` sites has `2 s - 2` slots, and
//! each point that the next stage inserts needs two. So each has two of its own, whatever else is inserted and when: a
//! site that comes back those that it left, a missing point `i` the slots `2 i - 2` and `2 i - 1`.
//!
//! # Ears
//!
//! A neighbor `l` between the neighbors `a` and `b` is an ear if `a l b` is strictly counterclockwise and the vertex
//! does not lie right of the diagonal from `a` to `b`; it may lie *on* it. To demand that it lie strictly left gets
//! stuck on lattices, where a vertex with four neighbors lies on both diagonals. The ear's triangle lies in the angle
//! in which the vertex sees it, and so it holds no other neighbor, and what remains is again a star around the vertex,
//! or has it on the cut edge.
//!
//! While more than three neighbors of an inner vertex remain there is an ear. The star is a simple polygon, so it has two
//! ears, in the usual sense, that do not overlap and whose tips are not the two ends of the cut edge the vertex lies on,
//! if it lies on one. At most one of them can have the vertex inside; the vertex sees the tip of the other beyond its
//! diagonal, which is what is demanded. With three left, the last triangle is counterclockwise for the same reason.
//!
//! Ears are cut in passes: in each, every ear that has no ear beside it of lower priority. The triangles that these cut off
//! lie in different angles around the vertex, so each of them is an ear whatever else is cut in the pass. Only where two
//! such angles make the whole turn nothing would be left: then four neighbors are, and of all ears the one with the least
//! priority is cut alone. The new edges spread over all neighbors; a scan around the star would give most of them to one, and
//! so the stars that are cut later grow. Most stars of `m` neighbors take about `log m` passes, at most `m`.
//!
//! Stars of more than [`LARGE`] triangles are scanned all the same, since no workgroup holds them: like Graham's scan, one
//! step back after a cut, one step on otherwise. Whatever lies behind has been found to be no ear as it stands, so a star of
//! `m` neighbors takes at most `3 m` steps, however large it is, and no memory but the mesh. Where it starts depends on
//! nothing but the mesh and who is pinned.
//!
//! # The hull
//!
//! The neighbors of a hull vertex are a chain that it sees with ascending angles, over half a turn at most. There is no ear
//! left when the chain is nowhere strictly reflex seen from outside, and what was cut off lies in what was the star. The two ends of the chain are vertices of the hull that each lose a triangle, so they turn left, and the hull is
//! convex again. Several neighbors of one vertex may go in one round: their stars do not overlap.
//!
//! When fewer than three vertices that are not on a line remain, there is no finite triangle left. If none of them is
//! pinned, they stay as a chain. Else the mesh becomes empty, and all sites count as taken out: the next stage then
//! starts from scratch.
//!
//! # Heirs
//!
//! An heir may go as well, in a later round; its own heir then serves. So the way to an heir that stays has fewer steps
//! than there are rounds.
//!
//! # In parallel
//!
//! The stars of a round share no triangle, but they may share edges, each of which one star sees on its outer side. All
//! stars are cut at the same time, without touching a triangle that is not in the star; it is noted where each outer edge
//! of the star has gone. Then each outer edge is linked: to the half-edge across if that is in no star, else to where
//! that one has gone.

use super::star::{broken, star};
use crate::DualizeError;
use glam::DVec2;
use polder_flip::priority;
use polder_mesh::{Cancelled, GHOST, GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, orient2d};

const STAGE: &str = "take out";

/// Larger stars than this are scanned, others are cut in passes.
pub(super) const LARGE: usize = 384;

/// What [`take_out`] did beside changing the mesh.
pub(super) struct Taken {
    /// For each vertex itself if it is still there, else its heir, or [`NONE`] if the mesh is empty.
    pub(super) heirs: Vec<u32>,
    /// For each vertex the slots that it freed, twice [`NONE`] if it is still there or the mesh is empty.
    pub(super) freed: Vec<[u32; 2]>,
    pub(super) rounds: u64,
}

/// Takes the pinned vertices out.
///
/// The mesh must be a triangulation of the positions `at` with a convex hull, or a chain, or empty.
pub(super) fn take_out(
    mesh: &mut GhostMesh,
    at: &[DVec2],
    mut pinned: Vec<bool>,
    go_on: &mut dyn FnMut() -> Result<(), Cancelled>,
) -> Result<Taken, DualizeError> {
    let mut heirs: Vec<u32> = (0..at.len() as u32).collect();
    let mut freed = vec![[NONE; 2]; at.len()];
    let mut gone = Vec::new();
    let mut left = pinned.iter().filter(|&&p| p).count();
    let bound = left as u64;
    let mut rounds = 0;
    if mesh.slots() == 0 {
        heirs.fill(NONE);
        return Ok(Taken { heirs, freed, rounds });
    }
    while left > 0 {
        go_on()?;
        if rounds == bound {
            return Err(DualizeError::BoundExceeded { stage: STAGE, bound });
        }
        rounds += 1;
        if mesh.finite().next().is_none() {
            *mesh = GhostMesh::default();
            heirs.fill(NONE);
            freed.fill([NONE; 2]);
            return Ok(Taken { heirs, freed, rounds });
        }
        let before = gone.len();
        for (v, h) in winners(mesh, &pinned) {
            let start = start(mesh, h, &pinned).ok_or(broken(STAGE, v))?;
            heirs[v as usize] = mesh.destination(start);
            freed[v as usize] = remove(mesh, at, start)?;
            gone.push(v);
        }
        gone[before..].iter().for_each(|&v: &u32| pinned[v as usize] = false);
        left -= gone.len() - before;
    }
    // An heir went later than the vertex that named it, so from the last one back each heir is final when it is read.
    for &v in gone.iter().rev() {
        heirs[v as usize] = heirs[heirs[v as usize] as usize];
    }
    Ok(Taken { heirs, freed, rounds })
}

/// Step 1: the vertices of this round, each with a half-edge out of it.
fn winners(mesh: &GhostMesh, pinned: &[bool]) -> Vec<(u32, u32)> {
    // Who is still to be decided on, with a half-edge of each.
    let mut first = vec![NONE; pinned.len()];
    let mut out = Vec::new();
    for h in 0..3 * mesh.slots() as u32 {
        let v = mesh.origin(h);
        if pinned.get(v as usize).is_some_and(|&p| p) {
            first[v as usize] = first[v as usize].min(h);
        }
    }
    for _ in 0..2 {
        let is_open = |u: u32| first.get(u as usize).is_some_and(|&h| h != NONE);
        let least = |v: &u32| {
            let mut around = star(mesh, first[*v as usize]).map(|h| mesh.destination(h));
            around.all(|u| !is_open(u) || priority(u) > priority(*v))
        };
        let turn: Vec<u32> = (0..pinned.len() as u32).filter(|&v| is_open(v)).filter(least).collect();
        for &v in &turn {
            let h = first[v as usize];
            for u in star(mesh, h).map(|h| mesh.destination(h)).filter(|&u| u != GHOST) {
                first[u as usize] = NONE;
            }
            first[v as usize] = NONE;
            out.push((v, h));
        }
    }
    out
}

/// Step 2: the half-edge from the origin of `h` to its heir.
fn start(mesh: &GhostMesh, h: u32, pinned: &[bool]) -> Option<u32> {
    let rank = |u: u32| (pinned.get(u as usize).copied().unwrap_or(false), u);
    star(mesh, h).filter(|&h| mesh.destination(h) != GHOST).min_by_key(|&h| rank(mesh.destination(h)))
}

/// Steps 3 and 4: takes out the origin of `start`, which leads to its heir; the slots that become free.
pub(super) fn remove(mesh: &mut GhostMesh, at: &[DVec2], start: u32) -> Result<[u32; 2], DualizeError> {
    let to_ghost = star(mesh, start).find(|&h| mesh.destination(h) == GHOST);
    let first = to_ghost.map_or(start, |h| mesh.rotate_ccw(h));
    let ring: Vec<u32> = star(mesh, first).collect();
    if ring.len() > LARGE { scan(mesh, at, first, to_ghost) } else { pass(mesh, at, ring, to_ghost) }
}

/// Takes out the origin of the half-edges in `ring`, which are its star; the last one is `to_ghost` if there is that.
fn pass(
    mesh: &mut GhostMesh,
    at: &[DVec2],
    mut ring: Vec<u32>,
    to_ghost: Option<u32>,
) -> Result<[u32; 2], DualizeError> {
    let v = ring.first().map_or(NONE, |&h| mesh.origin(h));
    let position = |u: u32| at[u as usize];
    while ring.len() > 3 || to_ghost.is_some() {
        let end = |i: usize| mesh.destination(ring[i % ring.len()]);
        let ears: Vec<bool> = (0..ring.len())
            .map(|i| {
                let corners = [end(i + ring.len() - 1), end(i), end(i + 1)];
                !corners.contains(&GHOST) && is_ear(position(v), corners.map(position))
            })
            .collect();
        // Before another ear, if there is one at that place of the ring.
        let before = |i: usize, other: usize| !ears[other % ring.len()] || priority(end(i)) < priority(end(other));
        let cut: Vec<usize> = (0..ring.len())
            .filter(|&i| ears[i] && before(i, i + 1) && before(i, i + ring.len() - 1))
            .filter(|&i| ring.len() > 4 || to_ghost.is_some() || before(i, i + 2))
            .collect();
        if cut.is_empty() {
            break;
        }
        let mut stays = vec![true; ring.len()];
        for i in cut {
            // The flip leaves the half-edge in the star: it now leads to the neighbor before.
            mesh.flip(ring[i]);
            stays[(i + ring.len() - 1) % ring.len()] = false;
        }
        let mut stays = stays.into_iter();
        ring.retain(|_| stays.next().unwrap_or(true));
    }
    match (to_ghost, &ring[..]) {
        (Some(_), [.., last, _]) => Ok(to_infinity(mesh, *last)),
        (None, &[first, _, _]) => Ok(merge(mesh, first)),
        _ => Err(broken(STAGE, v)),
    }
}

/// The same for a star of any size, without memory: `start` leads to the heir, or is next to the ghost.
fn scan(mesh: &mut GhostMesh, at: &[DVec2], start: u32, to_ghost: Option<u32>) -> Result<[u32; 2], DualizeError> {
    let v = mesh.origin(start);
    let mut left = star(mesh, start).count();
    let mut h = start;
    let position = |u: u32| at[u as usize];
    for _ in 0..4 * left {
        let (l, b, a) = (mesh.destination(h), mesh.apex(h), mesh.apex(mesh.twin(h)));
        if to_ghost.is_none() && left == 3 {
            return Ok(merge(mesh, h));
        }
        if b == GHOST {
            return Ok(to_infinity(mesh, h));
        }
        if a != GHOST && is_ear(position(v), [a, l, b].map(position)) {
            mesh.flip(h);
            left -= 1;
        } else {
            h = mesh.rotate_ccw(h);
        }
    }
    Err(broken(STAGE, v))
}

fn is_ear(p: DVec2, [a, l, b]: [DVec2; 3]) -> bool {
    orient2d(a, l, b) == Sign::Positive && orient2d(a, b, p) != Sign::Negative
}

/// Merges the three triangles around the origin of `h` into that of `h`, where the third neighbor takes its place.
fn merge(mesh: &mut GhostMesh, h: u32) -> [u32; 2] {
    let (ccw, cw) = (mesh.rotate_ccw(h), mesh.rotate_cw(h));
    let third = mesh.destination(cw);
    let (beyond_ccw, beyond_cw) = (mesh.twin(next(ccw)), mesh.twin(next(cw)));
    mesh.triangles[(h / 3) as usize][next(h) as usize % 3] = third;
    mesh.link(prev(h), beyond_ccw);
    mesh.link(h, beyond_cw);
    free(mesh, [ccw / 3, cw / 3])
}

/// Puts the ghost in the place of the origin of `h`, which leads to the last of its neighbors counterclockwise.
///
/// The outer edges of the two ghost triangles that vanish go to the finite triangles beside them.
fn to_infinity(mesh: &mut GhostMesh, h: u32) -> [u32; 2] {
    let to_ghost = mesh.rotate_ccw(h);
    let first = mesh.rotate_ccw(to_ghost);
    let last = mesh.twin(h);
    let (beyond_last, beyond_first) = (mesh.twin(next(h)), mesh.twin(next(to_ghost)));
    let mut spoke = first;
    while spoke != h {
        let following = mesh.rotate_ccw(spoke);
        mesh.triangles[(spoke / 3) as usize][next(spoke) as usize % 3] = GHOST;
        spoke = following;
    }
    mesh.link(last, beyond_last);
    mesh.link(first, beyond_first);
    free(mesh, [h / 3, to_ghost / 3])
}

fn free(mesh: &mut GhostMesh, slots: [u32; 2]) -> [u32; 2] {
    slots.map(|t| {
        mesh.delete(t as usize);
        t
    })
}
