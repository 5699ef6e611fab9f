//! Each kernel of [`gpu`](crate::gpu) as plain Rust on slices.

use super::{is_ghost_edge, is_illegal};
use crate::{FlipReport, priority};
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE, next, prev};

/// The mark of an illegal edge that was flipped.
pub const WON: u32 = 1 << 31;

/// What kernels keep, by triangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scratch {
    /// The least priority that claims it, else [`NONE`]: between the test of edges and the flips.
    pub claims: Vec<u32>,
    /// Four times the last round that flipped it, and the edge along which it was.
    pub stamps: Vec<u32>,
    /// The number of the last round that flipped.
    pub round: u32,
}

impl Scratch {
    /// For so many slots, before the first round.
    pub fn new(slots: usize) -> Self {
        Self { claims: vec![NONE; slots], stamps: vec![NONE; slots], round: 0 }
    }

    /// Along which half-edge a triangle was flipped in this round.
    fn flipped(&self, t: u32) -> Option<u32> {
        let stamp = self.stamps[t as usize];
        (stamp >> 2 == self.round).then_some(3 * t + (stamp & 3))
    }
}

/// Steps 1 and 2 of a round: which of these edges are illegal, in order, by their lower and their upper half-edge, after they
/// have claimed their triangles; and how many were tested. Each is taken once, by the lower half-edge of its edge, if its triangle is no free slot.
pub fn test_edges(
    mesh: &GhostMesh,
    positions: &[DVec2],
    edges: &[u32],
    hull_alone: bool,
    scratch: &mut Scratch,
) -> (Vec<[u32; 2]>, u64) {
    let mut taken: Vec<u32> =
        edges.iter().filter(|&&h| !mesh.is_deleted((h / 3) as usize)).map(|&h| h.min(mesh.twin(h))).collect();
    let mut listed = vec![false; 3 * mesh.slots()];
    taken.retain(|&h| !std::mem::replace(&mut listed[h as usize], true) && (!hull_alone || is_ghost_edge(mesh, h)));
    let tests = taken.len() as u64;
    taken.retain(|&h| is_illegal(mesh, positions, h));
    for &h in &taken {
        for t in [h / 3, mesh.twin(h) / 3] {
            let claim = &mut scratch.claims[t as usize];
            *claim = (*claim).min(priority(h));
        }
    }
    (taken.into_iter().map(|h| [h, mesh.twin(h)]).collect(), tests)
}

/// Step 3, first half: flips what got both its triangles, marks it [`WON`], and returns the number of flips. Links around
/// the flips keep their names from before the round. Whoever got a triangle gives it back.
pub fn flip_edges(mesh: &mut GhostMesh, scratch: &mut Scratch, illegal: &mut [[u32; 2]]) -> u64 {
    scratch.round += 1;
    let mut flips = 0;
    for [h, g] in illegal {
        let has = [*h, *g].map(|side| {
            let claim = &mut scratch.claims[(side / 3) as usize];
            let has = *claim == priority(*h);
            *claim = if has { NONE } else { *claim };
            has
        });
        if has != [true; 2] {
            continue;
        }
        let g = *g;
        let outer = [next(g), next(*h)].map(|side| (mesh.twin(side), mesh.is_constrained(side)));
        let (c, d) = (mesh.apex(*h), mesh.apex(g));
        for (side, corner, (link, constrained)) in [(*h, d, outer[0]), (g, c, outer[1])] {
            let (t, k) = polder_mesh::twin_code(side);
            mesh.triangles[t][(k + 2) % 3] = corner;
            mesh.links[t][k] = link;
            mark(mesh, side, constrained);
            mark(mesh, next(side), false);
            scratch.stamps[t] = scratch.round << 2 | k as u32;
        }
        mesh.link(next(*h), next(g));
        *h |= WON;
        flips += 1;
    }
    flips
}

/// Step 3, second half, and step 4: renews the links around the flips, and returns the edges of
/// the next round, each once by its lower half-edge.
pub fn relink_edges(mesh: &mut GhostMesh, scratch: &Scratch, illegal: &[[u32; 2]]) -> Vec<u32> {
    let mut handed = Vec::new();
    for &[entry, g] in illegal {
        let h = entry & !WON;
        if entry & WON == 0 {
            if scratch.flipped(h / 3).is_none() && scratch.flipped(g / 3).is_none() {
                handed.push(h);
            }
            continue;
        }
        for side in [h, g, prev(h), prev(g)] {
            let mut outer = mesh.twin(side);
            let flipped = scratch.flipped(outer / 3);
            if let Some(edge) = flipped {
                if outer == next(edge) {
                    outer = prev(mesh.twin(outer));
                }
                mesh.links[(side / 3) as usize][(side % 3) as usize] = outer;
            } else {
                mesh.links[(outer / 3) as usize][(outer % 3) as usize] = side;
            }
            if flipped.is_none() || side < outer {
                handed.push(side.min(outer));
            }
        }
    }
    handed
}

/// Steps 1 and 2 of a round over every edge of the mesh, or every ghost edge.
pub fn test_mesh(
    mesh: &GhostMesh,
    positions: &[DVec2],
    hull_alone: bool,
    scratch: &mut Scratch,
) -> (Vec<[u32; 2]>, u64) {
    let edges: Vec<u32> = (0..3 * mesh.slots() as u32).filter(|&h| mesh.twin(h) != NONE && h < mesh.twin(h)).collect();
    test_edges(mesh, positions, &edges, hull_alone, scratch)
}

/// Step 3, second half, and steps 1 and 2 of the next round: the illegal ones of the edges around the flips, and of those
/// left, and the number of tests.
pub fn advance_edges(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    illegal: &[[u32; 2]],
    hull_alone: bool,
    scratch: &mut Scratch,
) -> (Vec<[u32; 2]>, u64) {
    let handed = relink_edges(mesh, scratch, illegal);
    test_edges(mesh, positions, &handed, hull_alone, scratch)
}

/// Rounds from claims to claims, at most `most`, while there are illegal edges and fewer than `least` of them (four times as
/// many after the first): the illegal edges left, and what was done.
pub fn flip_tail(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    illegal: &[[u32; 2]],
    hull_alone: bool,
    [least, most]: [usize; 2],
    scratch: &mut Scratch,
) -> (Vec<[u32; 2]>, FlipReport) {
    let mut illegal = illegal.to_vec();
    let mut report = FlipReport::default();
    let mut limit = least;
    while !illegal.is_empty() && illegal.len() < limit && report.rounds < most as u64 {
        limit = least.saturating_mul(4);
        let flips = flip_edges(mesh, scratch, &mut illegal);
        let (next, tests) = advance_edges(mesh, positions, &illegal, hull_alone, scratch);
        illegal = next;
        report += FlipReport { rounds: 1, flips, tests };
    }
    (illegal, report)
}

fn mark(mesh: &mut GhostMesh, h: u32, yes: bool) {
    let (t, k) = polder_mesh::twin_code(h);
    mesh.constrained[t] = mesh.constrained[t] & !(1 << k) | u8::from(yes) << k;
}
