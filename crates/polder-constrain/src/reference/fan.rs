//! Which way a ray leaves the star of a vertex.

use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, orient2d};

/// How a ray leaves the star of the vertex where it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Departure {
    /// Along an edge: this half-edge, which starts at the vertex.
    Along(u32),
    /// Through a triangle: across this half-edge, opposite the vertex.
    Across(u32),
}

/// Of three collinear points, whether `w` and `b` lie on the same side of `v`.
pub(super) fn ahead(v: DVec2, w: DVec2, b: DVec2) -> bool {
    let forward = |p: DVec2| if p.x == v.x { p.y > v.y } else { p.x > v.x };
    forward(w) == forward(b)
}

/// Looks at the spokes of a vertex one after the other, beginning at half-edge `start`: one orientation test a spoke.
pub(super) fn depart_by_turning(mesh: &GhostMesh, positions: &[DVec2], start: u32, target: u32) -> Option<Departure> {
    let at = |v: u32| positions[v as usize];
    let (v, b) = (at(mesh.origin(start)), at(target));
    let side = |w: u32| if w == GHOST { Sign::Negative } else { orient2d(v, at(w), b) };
    let mut h = start;
    let mut right = side(mesh.destination(h));
    // A vertex has fewer spokes than the mesh has half-edges.
    for _ in 0..3 * mesh.slots() {
        let (w, x) = (mesh.destination(h), mesh.apex(h));
        if w != GHOST && right == Sign::Zero && ahead(v, at(w), b) {
            return Some(Departure::Along(h));
        }
        let left = side(x);
        if w != GHOST && x != GHOST && right == Sign::Positive && left == Sign::Negative {
            return Some(Departure::Across(next(h)));
        }
        h = mesh.rotate_ccw(h);
        right = left;
        if h == start {
            break;
        }
    }
    None
}

/// The same, beginning in the triangle in which it left the vertex before, if that is still there: `hint` is a half-edge of it.
pub(super) fn depart_from(
    mesh: &GhostMesh,
    positions: &[DVec2],
    hint: u32,
    spoke: u32,
    target: u32,
) -> Option<Departure> {
    let v = mesh.origin(spoke);
    let half_edges = if hint == NONE { [spoke; 3] } else { [hint, next(hint), prev(hint)] };
    let at_hint = half_edges.into_iter().find(|&h| mesh.origin(h) == v);
    let mut start = at_hint.unwrap_or(spoke);
    let at = |v: u32| positions[v as usize];
    for _ in 0..3 * mesh.slots() {
        let w = mesh.destination(start);
        if w == GHOST || orient2d(at(v), at(w), at(target)) != Sign::Negative {
            break;
        }
        start = mesh.rotate_cw(start);
    }
    depart_by_turning(mesh, positions, start, target)
}

/// A spoke of every vertex, and the spokes of *hubs* (vertices with many of them) in order, to be searched by halving:
/// else a hub through which many constraints run would cost its number of spokes for each.
pub(super) struct Fans {
    spoke: Vec<u32>,
    hubs: Vec<u32>,
    offsets: Vec<u32>,
    spokes: Vec<u32>,
}

/// From so many spokes on a vertex is a hub.
const HUB: u32 = 32;

impl Fans {
    pub(super) fn new(mesh: &GhostMesh, vertices: usize) -> Self {
        let spoke = mesh.half_edge_of_vertex(vertices);
        let mut degree = vec![0u32; vertices];
        for &v in mesh.triangles.iter().flatten() {
            if let Some(degree) = degree.get_mut(v as usize) {
                *degree += 1;
            }
        }
        let mut fans = Self { spoke, hubs: Vec::new(), offsets: vec![0], spokes: Vec::new() };
        for v in (0..vertices).filter(|&v| degree[v] >= HUB) {
            let mut h = fans.spoke[v];
            // At the hull the first spoke is the one after the ghost; in a chain there are few spokes, so no hubs.
            for _ in 0..degree[v] {
                if mesh.destination(mesh.rotate_cw(h)) == GHOST {
                    break;
                }
                h = mesh.rotate_cw(h);
            }
            for _ in 0..degree[v] {
                if mesh.destination(h) != GHOST {
                    fans.spokes.push(h);
                }
                h = mesh.rotate_ccw(h);
            }
            fans.hubs.push(v as u32);
            fans.offsets.push(fans.spokes.len() as u32);
        }
        fans
    }

    pub(super) fn has(&self, v: u32) -> bool {
        self.spoke.get(v as usize).is_some_and(|&h| h != NONE)
    }

    pub(super) fn depart(&self, mesh: &GhostMesh, positions: &[DVec2], from: u32, target: u32) -> Option<Departure> {
        let Ok(hub) = self.hubs.binary_search(&from) else {
            return depart_by_turning(mesh, positions, self.spoke[from as usize], target);
        };
        let spokes = &self.spokes[self.offsets[hub] as usize..self.offsets[hub + 1] as usize];
        let at = |v: u32| positions[v as usize];
        let (v, b, zero) = (at(from), at(target), at(mesh.destination(spokes[0])));
        // Angles are measured from the first spoke: those below a half turn come before the others.
        let lower_half = |p: DVec2| match orient2d(v, zero, p) {
            Sign::Positive => true,
            Sign::Zero => ahead(v, zero, p),
            Sign::Negative => false,
        };
        let target_is_low = lower_half(b);
        let not_after = |h: &u32| {
            let w = at(mesh.destination(*h));
            match (lower_half(w), target_is_low) {
                (true, false) => true,
                (false, true) => false,
                _ => orient2d(v, w, b) != Sign::Negative,
            }
        };
        let h = spokes[spokes.partition_point(not_after).checked_sub(1)?];
        let w = at(mesh.destination(h));
        if orient2d(v, w, b) == Sign::Zero && ahead(v, w, b) {
            Some(Departure::Along(h))
        } else if mesh.apex(h) == GHOST {
            None
        } else {
            Some(Departure::Across(next(h)))
        }
    }
}

/// One step of a straight walk from `a` to `b`: across half-edge `h`, whose origin lies right of the line and whose
/// destination lies left of it, into the triangle behind.
///
/// Gives the half-edge by which that triangle was entered and on which side of the line its apex lies; none at the
/// hull.
#[inline]
pub(super) fn enter(mesh: &GhostMesh, positions: &[DVec2], h: u32, line: [DVec2; 2]) -> Option<(u32, Sign)> {
    let g = mesh.twin(h);
    let apex = mesh.apex(g);
    (apex != GHOST).then(|| (g, orient2d(line[0], line[1], positions[apex as usize])))
}

/// The half-edge by which a triangle is left that was entered by `g`, if its apex lies on this side of the line.
#[inline]
pub(super) fn leave(g: u32, apex: Sign) -> u32 {
    if apex == Sign::Positive { next(g) } else { prev(g) }
}
