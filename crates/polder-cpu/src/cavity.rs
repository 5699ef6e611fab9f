//! The hole that a constraint tears, triangulated again.
//!
//! Each side of the strip is a polygon all of which is seen from the constraint, if only through slits: such a polygon
//! is triangulated in linear time by a stack that cuts off every ear as soon as it closes (Toussaint, Avis 1982).
//! Lawson flips then make it constrained Delaunay. The polygon may touch itself: an edge with the strip on both sides
//! lies twice on the border, and its two copies are joined with each other in the end.

use crate::mesh::{NONE, Slab, Tri, next, prev};
use crate::walk::Strip;
use glam::DVec2;
use polder_mesh::GHOST;
use polder_predicates::{Sign, must_flip, orient2d};

/// A border edge: what lies behind it.
#[derive(Clone, Copy)]
struct Border {
    /// Where the edge starts, on the way from the constraint's start to its end.
    from: u32,
    /// The half-edge on its other side, or the place in the borders of its other copy.
    behind: Behind,
    constrained: bool,
}

#[derive(Clone, Copy)]
enum Behind {
    Outside(u32),
    Copy(usize),
}

/// Memory that is kept from one constraint to the next.
#[derive(Default)]
pub(crate) struct Cavity {
    borders: Vec<Border>,
    /// For each border edge, the new half-edge inside.
    inner: Vec<u32>,
    stack: Vec<(u32, Lower)>,
    /// Half-edges to test.
    suspects: Vec<u32>,
    free: Vec<u32>,
}

/// The edge below an entry of the stack, to the entry before it.
#[derive(Clone, Copy)]
enum Lower {
    /// A border edge.
    Border(usize),
    /// The outer half-edge of an ear that was cut off.
    Ear(u32),
}

/// A bit of a triangle's marks that says that it belongs to the strip.
const IN_STRIP: u32 = 1 << 8;

impl Cavity {
    /// Replaces the triangles of a strip from vertex `a` to vertex `b`, with a constrained edge between them. Returns
    /// the number of flips; none if they ran past their bound.
    pub(crate) fn fill(
        &mut self,
        points: &[DVec2],
        slab: &mut Slab<'_>,
        half_edges: &mut [u32],
        strip: &Strip,
        b: u32,
    ) -> Option<u64> {
        self.collect(slab, strip);
        let split = strip.left.len();
        let left = self.triangulate(points, slab, half_edges, 0..split, b, Sign::Negative)?;
        let right = self.triangulate(points, slab, half_edges, split..self.borders.len(), b, Sign::Positive)?;
        slab.link(left, right);
        slab.constrain(left);
        self.join_copies(slab);
        self.flip(points, slab, half_edges, strip.tris.len())
    }

    /// Reads all borders before any triangle is overwritten.
    fn collect(&mut self, slab: &mut Slab<'_>, strip: &Strip) {
        self.borders.clear();
        self.free.clear();
        self.free.extend_from_slice(&strip.tris);
        for &t in &strip.tris {
            slab.tri_mut(t).v[3] |= IN_STRIP;
        }
        let sides = strip
            .left
            .iter()
            .map(|&h| (h, slab.destination(h)))
            .chain(strip.right.iter().map(|&h| (h, slab.origin(h))));
        let borders = sides.map(|(h, from)| Border {
            from,
            behind: Behind::Outside(slab.twin(h)),
            constrained: slab.is_constrained(h),
        });
        self.borders.extend(borders);
        self.inner.clear();
        self.inner.resize(self.borders.len(), NONE);

        // Where the other side is in the strip too, leave the place of each copy in the old link and look it up.
        let half_edge = |i: usize| if i < strip.left.len() { strip.left[i] } else { strip.right[i - strip.left.len()] };
        for i in 0..self.borders.len() {
            slab.set_twin(half_edge(i), i as u32);
        }
        for border in &mut self.borders {
            if let Behind::Outside(h) = border.behind
                && slab.tri(h >> 2).v[3] & IN_STRIP != 0
            {
                border.behind = Behind::Copy(slab.twin(h) as usize);
            }
        }
    }

    /// Triangulates one side; returns the half-edge along the constraint. `ear` is the turn of an ear on this side.
    fn triangulate(
        &mut self,
        points: &[DVec2],
        slab: &mut Slab<'_>,
        half_edges: &mut [u32],
        side: std::ops::Range<usize>,
        b: u32,
        ear: Sign,
    ) -> Option<u32> {
        let at = |v: u32| points[v as usize];
        self.stack.clear();
        self.stack.push((self.borders[side.start].from, Lower::Border(usize::MAX)));
        for i in side.clone() {
            let v = if i + 1 < side.end { self.borders[i + 1].from } else { b };
            let mut lower = Lower::Border(i);
            while let [.., (p, _), (q, below)] = self.stack[..] {
                if orient2d(at(p), at(q), at(v)) != ear {
                    break;
                }
                lower = Lower::Ear(self.cut(slab, half_edges, [p, q, v], [below, lower], ear)?);
                self.stack.pop();
            }
            self.stack.push((v, lower));
        }
        match self.stack[..] {
            [_, (_, Lower::Ear(h))] => Some(h),
            _ => None,
        }
    }

    /// Makes the triangle of an ear `q` between `p` and `v`; returns its half-edge between `p` and `v`.
    fn cut(
        &mut self,
        slab: &mut Slab<'_>,
        half_edges: &mut [u32],
        [p, q, v]: [u32; 3],
        [pq, qv]: [Lower; 2],
        ear: Sign,
    ) -> Option<u32> {
        let t = self.free.pop()?;
        // Corner 0 is the ear. Left of the constraint the chain runs clockwise around its polygon, right of it
        // counterclockwise.
        let (corners, edge_pq, edge_qv) = if ear == Sign::Negative {
            ([q, p, v, 0], 4 * t + 2, 4 * t + 1)
        } else {
            ([q, v, p, 0], 4 * t + 1, 4 * t + 2)
        };
        *slab.tri_mut(t) = Tri { v: corners, n: [NONE; 4] };
        for (edge, lower) in [(edge_pq, pq), (edge_qv, qv)] {
            match lower {
                Lower::Ear(h) => {
                    slab.link(edge, h);
                    self.suspects.push(edge);
                }
                Lower::Border(i) => {
                    let Border { behind, constrained, .. } = self.borders[i];
                    slab.set_mark(edge, constrained);
                    match behind {
                        Behind::Outside(h) => slab.link(edge, h),
                        Behind::Copy(_) => self.inner[i] = edge,
                    }
                }
            }
        }
        half_edges[corners[0] as usize] = 4 * t + 2;
        half_edges[corners[1] as usize] = 4 * t;
        half_edges[corners[2] as usize] = 4 * t + 1;
        Some(4 * t)
    }

    fn join_copies(&mut self, slab: &mut Slab<'_>) {
        for i in 0..self.borders.len() {
            if let Behind::Copy(j) = self.borders[i].behind {
                slab.link(self.inner[i], self.inner[j]);
                self.suspects.push(self.inner[i]);
            }
        }
    }

    /// Lawson flips until no suspect is left. The bound is the number of pairs of vertices around the hole: no edge
    /// comes back once it is flipped away.
    fn flip(&mut self, points: &[DVec2], slab: &mut Slab<'_>, half_edges: &mut [u32], strip: usize) -> Option<u64> {
        let at = |v: u32| points[v as usize];
        let bound = (strip as u64 + 2) * (strip as u64 + 2);
        let mut flips = 0;
        while let Some(h) = self.suspects.pop() {
            let g = slab.twin(h);
            if slab.is_constrained(h) {
                continue;
            }
            let (c, d, a, b) = (slab.apex(h), slab.apex(g), slab.origin(h), slab.destination(h));
            if c == GHOST || d == GHOST || !must_flip(at(c), at(a), at(b), at(d)) {
                continue;
            }
            flips += 1;
            if flips > bound {
                return None;
            }
            flip(slab, half_edges, h, g);
            self.suspects.extend([h, prev(h), g, prev(g)]);
        }
        Some(flips)
    }
}

/// Replaces the edge of a half-edge by the other diagonal; see `polder_mesh::GhostMesh::flip`.
fn flip(slab: &mut Slab<'_>, half_edges: &mut [u32], h: u32, g: u32) {
    let (h1, g1) = (next(h), next(g));
    let (t_outer, u_outer) = (slab.twin(h1), slab.twin(g1));
    let (t_mark, u_mark) = (slab.is_constrained(h1), slab.is_constrained(g1));
    let (c, d) = (slab.apex(h), slab.apex(g));
    let (h2, g2) = (prev(h), prev(g));
    slab.tri_mut(h >> 2).v[(h2 & 3) as usize] = d;
    slab.tri_mut(g >> 2).v[(g2 & 3) as usize] = c;
    slab.link(h, u_outer);
    slab.link(g, t_outer);
    slab.link(h1, g1);
    slab.set_mark(h, u_mark);
    slab.set_mark(g, t_mark);
    slab.set_mark(h1, false);
    slab.set_mark(g1, false);
    for e in [h, h1, h2, g, g1, g2] {
        half_edges[slab.origin(e) as usize] = e;
    }
}
