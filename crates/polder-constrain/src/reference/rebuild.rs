//! The triangles of a short chain are replaced at once.
//!
//! What a sub-constraint crosses is two polygons, one on either side of it. Each vertex between its ends sees the
//! sub-constraint along an edge of the chain, and these edges stand side by side. So any vertex that is strictly convex can be
//! cut off, in any order: nothing else lies in its triangle. The chain is gone through once, from the lower end to the higher
//! one. On either side the vertices that could not be cut off yet make a stack, and a vertex that comes cuts off as many on the
//! top as it can. The higher end cuts off all the rest.
//!
//! Each vertex between the ends is cut off once and each makes a triangle, as many as there were. The slots are those of
//! the triangles that brought the vertices, moved on by one: see [`rebuild`].
//!
//! Known before: \[QCT\] makes all of them by flips.

use super::place;
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, orient2d};
use std::collections::BTreeMap;

/// A vertex on one side of the sub-constraint, and the edge to it from the vertex before.
#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    edge: Edge,
    /// Where the triangle goes that cuts the vertex off.
    slot: u32,
}

/// An edge of a polygon, by a half-edge.
#[derive(Clone, Copy, Debug)]
enum Edge {
    /// Of the chain as it was, on this side.
    Old(u32),
    /// Of a new triangle, on the other side.
    New(u32),
}

/// New triangles, and what becomes of the edges around them.
struct Polygons {
    stacks: [Vec<Corner>; 2],
    triangles: Vec<(u32, [u32; 3])>,
    /// Half-edges of the chain as it was, and what they are now.
    moved: Vec<(u32, u32)>,
    /// Pairs of new half-edges.
    joined: Vec<[u32; 2]>,
}

impl Polygons {
    fn join(&mut self, new: u32, edge: Edge) {
        match edge {
            Edge::Old(old) => self.moved.push((old, new)),
            Edge::New(other) => self.joined.push([new, other]),
        }
    }

    /// The next vertex on the left (0) or on the right (1).
    fn push(&mut self, positions: &[DVec2], side: usize, corner: Corner) {
        let at = |v: u32| positions[v as usize];
        let (w, mut edge) = (corner.vertex, corner.edge);
        while let [.., p, u] = self.stacks[side][..] {
            let [first, last] = if side == 0 { [w, p.vertex] } else { [p.vertex, w] };
            if orient2d(at(first), at(u.vertex), at(last)) != Sign::Positive {
                break;
            }
            self.stacks[side].pop();
            // From the vertex that is cut off on, counterclockwise.
            self.triangles.push((u.slot, [u.vertex, last, first]));
            let (into, out_of) = if side == 0 { (edge, u.edge) } else { (u.edge, edge) };
            self.join(3 * u.slot + 1, into);
            self.join(3 * u.slot + 2, out_of);
            edge = Edge::New(3 * u.slot);
        }
        self.stacks[side].push(Corner { edge, ..corner });
    }
}

/// Makes a sub-constraint an edge that owns each triangle of its chain, of which there are at least two. `h` is the half-edge
/// by which it leaves the one at its lower end. Gives the slots of the chain; nothing, and changes nothing, if the mesh is no
/// triangulation. The words of owners stay.
///
/// A vertex that is cut off makes its triangle in the slot after that of the triangle whose corner it was first; the first
/// vertex on the right, in the first slot.
pub(super) fn rebuild(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    owner: &[u32],
    h: u32,
    [spokes, degrees]: [&mut [u32]; 2],
) -> Option<Vec<u32>> {
    let mut slots = vec![h / 3];
    let corner = |vertex, old, slot| Corner { vertex, edge: Edge::Old(old), slot };
    let low = corner(mesh.apex(h), NONE, NONE);
    let stacks = [vec![low], vec![low]];
    let mut polygons = Polygons { stacks, triangles: Vec::new(), moved: Vec::new(), joined: Vec::new() };
    let mut g = mesh.twin(h);
    polygons.push(positions, 0, corner(mesh.destination(h), next(h), g / 3));
    polygons.push(positions, 1, corner(mesh.origin(h), prev(h), h / 3));
    // No chain has more triangles than the mesh.
    for _ in 0..mesh.slots() {
        slots.push(g / 3);
        let w = mesh.apex(g);
        let Some(gate) = place::outward(owner[(g / 3) as usize]) else {
            polygons.push(positions, 0, corner(w, prev(g), NONE));
            polygons.push(positions, 1, corner(w, next(g), NONE));
            break;
        };
        let out = g - g % 3 + gate;
        let beyond = mesh.twin(out);
        let (side, old) = if out == next(g) { (0, prev(g)) } else { (1, next(g)) };
        polygons.push(positions, side, corner(w, old, beyond / 3));
        g = beyond;
    }
    let [[_, high], [_, last]] = [&polygons.stacks[0][..], &polygons.stacks[1][..]] else { return None };
    let (Edge::New(left), Edge::New(right)) = (high.edge, last.edge) else { return None };
    let ends = [low.vertex, high.vertex];
    // Edges with the chain on both sides have moved on both.
    let now: BTreeMap<u32, u32> = polygons.moved.iter().copied().collect();
    let outer: Vec<_> =
        polygons.moved.iter().map(|&(old, new)| (new, mesh.twin(old), mesh.is_constrained(old))).collect();
    for &(slot, corners) in &polygons.triangles {
        mesh.triangles[slot as usize] = corners;
        mesh.constrained[slot as usize] = 0;
        for (v, h) in [(0, 2), (1, 0), (2, 1)] {
            spokes[corners[v] as usize] = 3 * slot + h;
            degrees[corners[v] as usize] += u32::from(ends.contains(&corners[v]));
        }
    }
    for [g, h] in polygons.joined {
        mesh.link(g, h);
    }
    for (new, outer, constrained) in outer {
        mesh.link(new, now.get(&outer).copied().unwrap_or(outer));
        mesh.set_constrained(new, constrained);
    }
    for v in ends {
        degrees[v as usize] -= 1;
    }
    mesh.link(left, right);
    mesh.set_constrained(left, true);
    Some(slots)
}
