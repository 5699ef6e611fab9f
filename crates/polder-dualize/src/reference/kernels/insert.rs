//! The kernels of stage 4, which `reference::insert` is made of.
//!
//! For each point that waits there are two words, the point and a half-edge from which the next walk starts, and two more,
//! its place and its score or, once it has claimed, the second triangle of its edge. The *place* is three times the slot of
//! a triangle, or with [`ON_EDGE`] a half-edge, the lower one of its edge; [`NONE`] for a point that is done. [`WON`] says
//! that it got what it claims.
//!
//! For each slot there are three words of claims: the least score, the least precedence among points with that score, and
//! when the triangle was split last: four times the round, and 3 if the point lies inside, or else which of its edges was
//! split.

use super::super::certify::before;
use super::super::key;
use super::super::key::precedence;
use super::super::locate::{Place, Walk};
use super::super::sector::{Center, sector};
use crate::DualizeError;
use glam::DVec2;
use polder_flip::priority;
use polder_mesh::{GHOST, GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, orient2d};

/// The mark of a place on an edge.
pub const ON_EDGE: u32 = 1 << 31;
/// The mark of the place of a point that got what it claims.
pub const WON: u32 = 1 << 30;
/// The bits of a place that name a half-edge.
pub const PLACE: u32 = WON - 1;

/// Rounds in a row after which a mesh that seems to fall behind has fallen behind.
pub const BEHIND: u32 = 2;

/// What [`insert_begin`] finds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Begun {
    /// For each vertex a half-edge out of it, or [`NONE`]. Any will do: a walk ends at the same place wherever it starts.
    pub half_edges: Vec<u32>,
    /// The lowest finite triangle, or [`NONE`].
    pub center_slot: u32,
    /// Whether the mesh has any triangle.
    pub chain: bool,
}

/// Where walks may start, and what mesh it is.
pub fn insert_begin(mesh: &GhostMesh, vertices: usize) -> Begun {
    Begun {
        half_edges: mesh.half_edge_of_vertex(vertices),
        center_slot: mesh.finite().next().map_or(NONE, |t| t as u32),
        chain: (0..mesh.slots()).any(|t| !mesh.is_deleted(t)),
    }
}

/// The lexicographically first and last of some vertices, the lowest of equal ones; twice [`NONE`] for none.
pub fn insert_ends(positions: &[DVec2], candidates: impl Iterator<Item = u32>) -> [u32; 2] {
    let at = |v: u32| positions[v as usize];
    candidates.fold([NONE; 2], |[first, last], v| {
        let better = |u: u32, ahead: bool, behind: bool| if u == NONE || ahead || !behind && v < u { v } else { u };
        let order = |u: u32| if u == NONE { (true, true) } else { (before(at(v), at(u)), before(at(u), at(v))) };
        let ((up, down), (left, right)) = (order(first), order(last));
        [better(first, up, down), better(last, right, left)]
    })
}

/// The least priority of the points off the line through two of them; [`NONE`] if there are none.
pub fn insert_apex(positions: &[DVec2], [a, b]: [u32; 2]) -> u32 {
    let [p, q] = [a, b].map(|v| positions[v as usize]);
    let off = |v: &u32| orient2d(p, q, positions[*v as usize]) != Sign::Zero;
    (0..positions.len() as u32).filter(off).map(priority).min().unwrap_or(NONE)
}

/// A chain and one more vertex, with its two slots, become a triangulation.
pub fn insert_join(mesh: &mut GhostMesh, positions: &[DVec2], apex: u32, [s, t]: [u32; 2]) {
    let at = |v: u32| positions[v as usize];
    let chain: Vec<u32> = (0..mesh.slots() as u32).filter(|&g| mesh.is_ghost(g as usize)).collect();
    mesh.link(3 * s + 1, 3 * t);
    for ghost in chain {
        let Some(k) = mesh.triangles[ghost as usize].iter().position(|&v| v == GHOST) else { continue };
        let h = 3 * ghost + k as u32;
        // The hull edge from u to w.
        let (w, u) = (mesh.origin(h), mesh.destination(h));
        if orient2d(at(w), at(u), at(apex)) != Sign::Positive {
            continue;
        }
        mesh.triangles[ghost as usize][k] = apex;
        // Where the ring of ghost triangles turns back, the next one is that of the same edge, seen from behind.
        let (to_u, to_w) = (next(h), prev(h));
        let (behind, ahead) = (mesh.twin(to_u), mesh.twin(to_w));
        if mesh.apex(behind) == w {
            mesh.triangles[s as usize] = [apex, u, GHOST];
            mesh.link(3 * s, behind);
            mesh.link(3 * s + 2, to_u);
        }
        if mesh.apex(ahead) == u {
            mesh.triangles[t as usize] = [w, apex, GHOST];
            mesh.link(3 * t + 1, ahead);
            mesh.link(3 * t + 2, to_w);
        }
    }
}

/// Each point with the half-edge from which the walk to it starts.
pub fn insert_wait(begun: &Begun, points: &[u32], starts: &[u32]) -> Vec<[u32; 2]> {
    let from = |v: u32| begun.half_edges.get(v as usize).copied().filter(|&h| h != NONE);
    let anywhere = 3 * begun.center_slot;
    points.iter().zip(starts).map(|(&point, &start)| [point, from(start).unwrap_or(anywhere)]).collect()
}

/// What [`insert_locate`] finds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Located {
    /// Place and score of each point.
    pub places: Vec<[u32; 2]>,
    /// Points on vertices, each with its vertex.
    pub on_vertices: Vec<[u32; 2]>,
    /// Steps of walks, and of searches for a sector.
    pub steps: [u64; 2],
}

/// Finds the container of each point, seen from `center` if outside, and claims it by score.
///
/// # Errors
///
/// If a walk or search does not end.
pub fn insert_locate(
    mesh: &GhostMesh,
    positions: &[DVec2],
    center: [DVec2; 3],
    waiting: &[[u32; 2]],
    claims: &mut [[u32; 3]],
) -> Result<Located, DualizeError> {
    let at = |v: u32| positions[v as usize];
    let mut walk = Walk { mesh, positions, steps: 0 };
    let mut out = Located::default();
    for &[point, from] in waiting {
        let p = at(point);
        let place = match walk.locate(point, from)? {
            Place::Vertex(v) => {
                out.on_vertices.push([point, v]);
                out.places.push([NONE, key::INSIDE]);
                continue;
            }
            Place::Inside(t) => 3 * t,
            // One name for each edge, whichever way the walk came.
            Place::Edge(h) => h.min(mesh.twin(h)) | ON_EDGE,
            Place::Outside(ghost) => 3 * sector(mesh, positions, &Center(center), p, ghost, &mut out.steps[1])?,
        };
        let h = place & PLACE;
        let score = match mesh.triangles[(h / 3) as usize] {
            _ if place & ON_EDGE != 0 => key::on_edge(p, [mesh.origin(h), mesh.destination(h)].map(at)),
            // The hull edge from u to w.
            [GHOST, w, u] | [u, GHOST, w] | [w, u, GHOST] => key::outside(p, [u, w].map(at)),
            _ => key::INSIDE,
        };
        for t in triangles(mesh, place) {
            let least = &mut claims[t as usize][0];
            *least = (*least).min(score);
        }
        out.places.push([place, score]);
    }
    out.steps[0] = walk.steps;
    Ok(out)
}

/// Of the points with the least score of a triangle, the one with the least precedence gets it.
pub fn insert_claim(mesh: &GhostMesh, waiting: &[[u32; 2]], places: &mut [[u32; 2]], claims: &mut [[u32; 3]]) {
    for (&[point, _], entry) in waiting.iter().zip(places) {
        let [place, score] = *entry;
        for t in triangles(mesh, place) {
            let [least, first, _] = &mut claims[t as usize];
            if *least == score {
                *first = (*first).min(precedence(point));
            }
            if place & ON_EDGE != 0 {
                entry[1] = t;
            }
        }
    }
}

/// Points that got all they claim split it; returns the others, with where their next walks start. Outer edges of what was
/// split keep the name of their other side. `slots` are the two of each point.
pub fn insert_graft(
    mesh: &mut GhostMesh,
    slots: &[[u32; 2]],
    waiting: &[[u32; 2]],
    places: &mut [[u32; 2]],
    claims: &mut [[u32; 3]],
    round: u32,
) -> Vec<[u32; 2]> {
    let mut losers = Vec::new();
    for (&[point, _], entry) in waiting.iter().zip(places) {
        let [place, other] = *entry;
        let h = place & PLACE;
        let got = |t: u32| claims[t as usize][1] == precedence(point);
        if place == NONE {
            continue;
        }
        if !got(h / 3) || place & ON_EDGE != 0 && !got(other) {
            // The slot still has a triangle next to the point, with the new vertex, which has few neighbors, at corner 2.
            losers.push([point, if place & ON_EDGE == 0 { h + 1 } else { h }]);
            continue;
        }
        entry[0] |= WON;
        let [s, u] = slots[point as usize];
        if place & ON_EDGE == 0 {
            claims[(h / 3) as usize][2] = round << 2 | 3;
            split_triangle(mesh, h / 3, point, [s, u]);
        } else {
            let g = mesh.twin(h);
            for (side, slot) in [(h, s), (g, u)] {
                claims[(side / 3) as usize][2] = round << 2 | (side % 3);
                split_side(mesh, side, point, slot);
            }
            mesh.link(h, 3 * u);
            mesh.link(g, 3 * s);
        }
    }
    losers
}

/// Triangle `t` with corners `a, b, c` becomes `a, b, p`; slot `s` has `b, c, p` and `u` has `c, a, p`. Edge 2 of each is
/// the outer one.
fn split_triangle(mesh: &mut GhostMesh, t: u32, p: u32, [s, u]: [u32; 2]) {
    let [a, b, c] = mesh.triangles[t as usize];
    let [first, second, _] = mesh.links[t as usize];
    mesh.triangles[t as usize][2] = p;
    mesh.triangles[s as usize] = [b, c, p];
    mesh.triangles[u as usize] = [c, a, p];
    for (from, to) in [(t, s), (s, u), (u, t)] {
        mesh.link(3 * from, 3 * to + 1);
    }
    mesh.links[s as usize][2] = first;
    mesh.links[u as usize][2] = second;
}

/// Half-edge `side` from `a` to `b` of triangle `c, a, b` then leads to `p`, and slot `s` has `c, p, b`.
fn split_side(mesh: &mut GhostMesh, side: u32, p: u32, s: u32) {
    let (apex, end, outer) = (mesh.apex(side), mesh.destination(side), mesh.twin(next(side)));
    mesh.triangles[s as usize] = [apex, p, end];
    mesh.triangles[(side / 3) as usize][prev(side) as usize % 3] = p;
    mesh.link(next(side), 3 * s + 2);
    mesh.links[s as usize][1] = outer;
}

/// Outer edges of what was split get their links, and claims are cleared. Returns half-edges: if flips are to be made, of the
/// edges around new vertices, those at the ghost vertex left out, and none twice; and of all edges of new ghost triangles.
#[allow(clippy::too_many_arguments, reason = "those of a kernel")]
pub fn insert_relink(
    mesh: &mut GhostMesh,
    slots: &[[u32; 2]],
    waiting: &[[u32; 2]],
    places: &[[u32; 2]],
    claims: &mut [[u32; 3]],
    round: u32,
    flips: bool,
) -> [Vec<u32>; 2] {
    let [mut edges, mut hull] = [Vec::new(), Vec::new()];
    for (&[point, _], &[place, other]) in waiting.iter().zip(places) {
        if place == NONE {
            continue;
        }
        let h = place & PLACE;
        let on_edge = place & ON_EDGE != 0;
        for t in std::iter::once(h / 3).chain(on_edge.then_some(other)) {
            claims[t as usize][..2].fill(NONE);
        }
        if place & WON == 0 {
            continue;
        }
        let [s, u] = slots[point as usize];
        let outer = if on_edge {
            let g = mesh.twin(3 * s);
            vec![prev(h), prev(g), 3 * s + 1, 3 * u + 1]
        } else {
            vec![h + 2, 3 * s + 2, 3 * u + 2]
        };
        for side in outer {
            let old = mesh.twin(side);
            let split = renamed(mesh, claims, round, old);
            match split {
                Some(new) => mesh.links[(side / 3) as usize][side as usize % 3] = new,
                None => mesh.link(side, old),
            }
            // An edge between two that were split is on the list by its lower side.
            let once = split.is_none_or(|new| side < new);
            let finite = mesh.origin(side) != GHOST && mesh.destination(side) != GHOST;
            edges.extend((flips && once && finite).then_some(side));
        }
        let parts = [h / 3, s, u].into_iter().chain(on_edge.then_some(other));
        for t in parts.filter(|&t| mesh.is_ghost(t as usize)) {
            hull.extend([3 * t, 3 * t + 1, 3 * t + 2]);
        }
    }
    [edges, hull]
}

/// The name that half-edge `g` of a triangle split in this round has now; nothing if it was not split. The links between the
/// parts tell where it went.
fn renamed(mesh: &GhostMesh, claims: &[[u32; 3]], round: u32, g: u32) -> Option<u32> {
    let split = claims[(g / 3) as usize][2];
    if split >> 2 != round {
        return None;
    }
    Some(match (split & 3, g % 3) {
        (3, 0) => mesh.twin(g) + 1,
        (3, 1) => mesh.twin(g) + 2,
        // Behind the edge, what is left of the triangle leads to the rest of it.
        (edge @ 0..3, k) if k == (edge + 1) % 3 => mesh.twin(g) - 1,
        _ => g,
    })
}

/// How many rounds in a row, this one included, the mesh seems to fall behind, after `before` of them; from [`BEHIND`] on it
/// has. In the round flips were tried with so many edges around new vertices, of which so many were illegal; so many points
/// wait, and so many are inserted.
///
/// Around a new vertex of a Delaunay triangulation more than half of the edges are illegal. In slivers that wait for their
/// flips fewer are, and ever fewer the more slivers there are. Few edges, and those of the last rounds, say nothing; where
/// next to none is illegal none need be flipped.
pub fn insert_turn(before: u32, [edges, illegal]: [u32; 2], waiting: u32, inserted: u32) -> u32 {
    let telling = edges >= 256 && edges >= waiting / 32 && waiting >= inserted / 2;
    if telling && illegal >= edges / 16 && illegal < edges / 2 - edges / 128 { before + 1 } else { 0 }
}

/// The slots of points that wait become free.
pub fn insert_clear(mesh: &mut GhostMesh, slots: &[[u32; 2]], waiting: &[[u32; 2]]) {
    for t in waiting.iter().flat_map(|&[point, _]| slots[point as usize]) {
        mesh.delete(t as usize);
    }
}

/// How many points the next round takes in a mesh that fell behind: all that wait, once no edge is left to be flipped.
pub fn insert_resume(waiting: u32, pending: u32) -> u32 {
    if pending == 0 { waiting } else { 0 }
}

/// The triangles that a place claims.
fn triangles(mesh: &GhostMesh, place: u32) -> impl Iterator<Item = u32> + use<> {
    let h = place & PLACE;
    let first = (place != NONE).then_some(h / 3);
    let second = (place != NONE && place & ON_EDGE != 0).then(|| mesh.twin(h) / 3);
    first.into_iter().chain(second)
}
