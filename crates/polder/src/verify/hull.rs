//! Step 4: the boundary is the convex hull.

use super::mesh::Mesh;
use super::points::compare;
use super::stars::Star;
use super::verdict::{Found, Kind, Place};
use polder_mesh::next;
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;

/// A closed line of boundary edges.
struct Cycle {
    /// Its edges, the mesh on their left, from the lowest half-edge on.
    edges: Vec<u32>,
    /// How often its direction goes round, counterclockwise.
    turns: i64,
}

pub(super) fn check(mesh: &Mesh<'_>, stars: &[Star], found: &mut Found) {
    let cycles = cycles(mesh, stars);
    let place = |h: u32| Place::Edge { ends: [mesh.origin(h), mesh.destination(h)], triangle: h / 3 };
    let mut outer = None;
    for cycle in &cycles {
        if cycle.turns <= 0 {
            found.add(Kind::Hole, place(cycle.edges[0]));
        } else if outer.is_none() {
            outer = Some(cycle);
        } else {
            found.add(Kind::Pieces, place(cycle.edges[0]));
        }
    }
    let Some(outer) = outer else { return };
    if outer.turns > 1 {
        found.add(Kind::WindsTwice, place(outer.edges[0]));
    }
    let n = outer.edges.len();
    found.sweep(n, |range, found| {
        for i in range {
            let corner = [outer.edges[(i + n - 1) % n], outer.edges[i]];
            if matches!(turn(mesh, corner), Turn::Right | Turn::Back) {
                found.add(Kind::Notch, Place::Point(mesh.origin(corner[1])));
            }
        }
    });
}

/// How two successive boundary edges meet.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    Left,
    Straight,
    Right,
    Back,
}

fn turn(mesh: &Mesh<'_>, [before, after]: [u32; 2]) -> Turn {
    let [a, b, c] = [mesh.origin(before), mesh.origin(after), mesh.destination(after)].map(|v| mesh.point(v));
    match orient2d(a, b, c) {
        Sign::Positive => Turn::Left,
        Sign::Negative => Turn::Right,
        Sign::Zero if compare(a, b) == compare(b, c) => Turn::Straight,
        Sign::Zero => Turn::Back,
    }
}

/// Cuts the boundary into closed lines: after an edge comes the next boundary edge counterclockwise around its end.
fn cycles(mesh: &Mesh<'_>, stars: &[Star]) -> Vec<Cycle> {
    let open = |v: u32| mesh.outgoing(v).map(|out| out.half_edge).filter(|&h| mesh.twin(h).is_none());
    let at_boundary = (0..mesh.vertices() as u32).into_par_iter().filter(|&v| stars[v as usize] != Star::Closed);
    let mut edges: Vec<u32> = at_boundary.flat_map_iter(open).collect();
    edges.par_sort_unstable();

    let mut met = vec![false; edges.len()];
    let mut cycles = Vec::new();
    for first in 0..edges.len() {
        let mut cycle = Cycle { edges: Vec::new(), turns: 0 };
        let mut at = first;
        while !met[at] {
            met[at] = true;
            cycle.edges.push(edges[at]);
            let Ok(after) = edges.binary_search(&boundary_after(mesh, edges[at])) else { break };
            at = after;
        }
        if !cycle.edges.is_empty() {
            cycle.turns = turns(mesh, &cycle.edges);
            cycles.push(cycle);
        }
    }
    cycles
}

/// The boundary edge that starts where `h` ends and is reached through the triangles around that vertex.
fn boundary_after(mesh: &Mesh<'_>, h: u32) -> u32 {
    let mut after = next(h);
    for _ in 0..mesh.degree(mesh.origin(after)) {
        match mesh.twin(after) {
            Some(other) => after = next(other),
            None => break,
        }
    }
    after
}

/// How often the direction of a closed line goes round: left turns less right turns, counted only where the direction
/// changes from backward to forward in lexicographic order, which each turn around passes once.
fn turns(mesh: &Mesh<'_>, edges: &[u32]) -> i64 {
    let forward = |h: u32| compare(mesh.point(mesh.origin(h)), mesh.point(mesh.destination(h))).is_lt();
    let before = edges.iter().cycle().skip(edges.len() - 1);
    let corners = before.zip(edges).filter(|&(&before, &after)| !forward(before) && forward(after));
    corners
        .map(|(&before, &after)| match turn(mesh, [before, after]) {
            Turn::Left => 1,
            Turn::Right => -1,
            Turn::Straight | Turn::Back => 0,
        })
        .sum()
}
