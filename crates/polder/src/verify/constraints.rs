//! Step 5: each constraint is a chain of mesh edges.

use super::mesh::Mesh;
use super::points::compare;
use super::verdict::{Found, Kind, Place};
use polder_mesh::Constraint;
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// Which edges are part of a constraint: bit `k` of triangle `t` for half-edge `3t + k`.
pub(super) struct Marks(Vec<AtomicU8>);

impl Marks {
    fn set(&self, h: u32) {
        if let Some(bits) = self.0.get(h as usize / 3) {
            bits.fetch_or(1 << (h % 3), Relaxed);
        }
    }

    pub(super) fn has(&self, h: u32) -> bool {
        self.0.get(h as usize / 3).is_some_and(|bits| bits.load(Relaxed) >> (h % 3) & 1 == 1)
    }
}

/// Walks along every constraint, reports those that the mesh lacks and marks the edges of all.
pub(super) fn check(mesh: &Mesh<'_>, representatives: &[u32], constraints: &[Constraint], found: &mut Found) -> Marks {
    if constraints.is_empty() || mesh.triangles.is_empty() {
        return Marks(Vec::new());
    }
    let marks = Marks((0..mesh.triangles.len()).map(|_| AtomicU8::new(0)).collect());
    let fans = Fans::new(mesh);
    found.sweep(constraints.len(), |range, found| {
        for i in range {
            let [mut from, to] = constraints[i].map(|end| representatives[end as usize]);
            // Every step comes closer to the end, so this ends.
            while from != to {
                let Some(on) = fans.along(from, to) else {
                    found.add(Kind::MissingConstraint, Place::Constraint { constraint: i as u32, vertex: from });
                    break;
                };
                let sides = [mesh.find(from, on), mesh.find(on, from)];
                sides.into_iter().flatten().for_each(|h| marks.set(h));
                from = on;
            }
        }
    });
    marks
}

/// Finds the edge out of a vertex in a given direction. The neighbors of vertices of high degree are sorted by angle, so
/// that a hub of many constraints costs a binary search each.
struct Fans<'a> {
    mesh: &'a Mesh<'a>,
    /// The vertices of high degree, sorted, each with where its neighbors end.
    hubs: Vec<(u32, u32)>,
    neighbors: Vec<u32>,
}

/// Up to this degree all neighbors are tried.
const FEW: usize = 48;

impl<'a> Fans<'a> {
    fn new(mesh: &'a Mesh<'a>) -> Self {
        let hub = |&v: &u32| mesh.degree(v) > FEW;
        let sorted = |v: u32| {
            let mut neighbors: Vec<_> = neighbors(mesh, v).collect();
            neighbors.sort_unstable();
            neighbors.dedup();
            neighbors.par_sort_by(|&p, &q| angular(mesh, v, p, q).then(distance(mesh, v, p, q)));
            (v, neighbors)
        };
        let all: Vec<_> = (0..mesh.vertices() as u32).into_par_iter().filter(hub).map(sorted).collect();
        let mut fans = Self { mesh, hubs: Vec::new(), neighbors: Vec::new() };
        for (v, neighbors) in all {
            fans.neighbors.extend(neighbors);
            fans.hubs.push((v, fans.neighbors.len() as u32));
        }
        fans
    }

    /// The nearest neighbor of `from` on the segment to `to`.
    fn along(&self, from: u32, to: u32) -> Option<u32> {
        let mesh = self.mesh;
        if mesh.degree(from) <= FEW {
            if neighbors(mesh, from).any(|v| v == to) {
                return Some(to);
            }
            let on = neighbors(mesh, from).filter(|&v| between(mesh, from, v, to));
            return on.min_by(|&p, &q| distance(mesh, from, p, q));
        }
        let hub = self.hubs.partition_point(|hub| hub.0 < from);
        let begin = hub.checked_sub(1).map_or(0, |before| self.hubs[before].1);
        let fan = &self.neighbors[begin as usize..self.hubs.get(hub)?.1 as usize];
        let at = fan.partition_point(|&v| angular(mesh, from, v, to).is_lt());
        fan.get(at).copied().filter(|&v| v == to || between(mesh, from, v, to))
    }
}

/// The neighbors of a vertex, most of them twice.
fn neighbors<'a>(mesh: &'a Mesh<'_>, v: u32) -> impl Iterator<Item = u32> + 'a {
    mesh.outgoing(v).flat_map(|out| [out.destination, mesh.apex(out.half_edge)])
}

/// Whether `v` lies on the segment between two points.
fn between(mesh: &Mesh<'_>, from: u32, v: u32, to: u32) -> bool {
    let [a, p, b] = [from, v, to].map(|v| mesh.point(v));
    let order = compare(a, b);
    compare(a, p) == order && compare(p, b) == order && orient2d(a, b, p) == Sign::Zero
}

/// Compares the directions from `v` to `p` and `q`: by angle, counterclockwise from straight down (excluded).
fn angular(mesh: &Mesh<'_>, v: u32, p: u32, q: u32) -> Ordering {
    let [v, p, q] = [v, p, q].map(|v| mesh.point(v));
    let half = |p| compare(p, v).is_lt();
    half(p).cmp(&half(q)).then_with(|| match orient2d(v, p, q) {
        Sign::Positive => Ordering::Less,
        Sign::Zero => Ordering::Equal,
        Sign::Negative => Ordering::Greater,
    })
}

/// Compares how far two points in the same direction from `v` are.
fn distance(mesh: &Mesh<'_>, v: u32, p: u32, q: u32) -> Ordering {
    let [v, p, q] = [v, p, q].map(|v| mesh.point(v));
    if compare(v, p).is_lt() { compare(p, q) } else { compare(q, p) }
}
