//! The working mesh of the stages.

use crate::MeshError;

/// The ghost vertex: the vertex at infinity, which closes the hull (\[CET\]'s dummy seed `x₀`).
pub const GHOST: u32 = u32::MAX;
/// All three corners of a slot that holds no triangle.
pub const DELETED: u32 = u32::MAX - 1;
/// No triangle, no half-edge.
pub const NONE: u32 = u32::MAX;

/// The next half-edge of the same triangle, counterclockwise.
#[inline]
pub const fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The previous half-edge of the same triangle.
#[inline]
pub const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// Splits a half-edge into its triangle and edge number.
#[inline]
pub const fn twin_code(h: u32) -> (usize, usize) {
    ((h / 3) as usize, (h % 3) as usize)
}

/// A triangulation of the sphere: finite triangles, and ghost triangles that join each hull edge to [`GHOST`].
///
/// It is a Delta-complex, not always a simplicial complex: two triangles may share more than one edge, as the
/// ghost triangles on both sides of a chain of collinear vertices do. Therefore links name half-edges, not
/// triangles. A hull edge from `a` to `b` (counterclockwise, the interior on its left) has the ghost triangle
/// with corners `b, a, GHOST` in that cyclic order.
///
/// Its text form (`Display`) lists one triangle a line: its slot, its corners, its links, with `*` for the
/// ghost vertex and `!` before a constrained edge's link.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GhostMesh {
    /// Corners of each triangle, counterclockwise; three times [`DELETED`] in a free slot.
    pub triangles: Vec<[u32; 3]>,
    /// For each edge of each triangle, the half-edge on its other side ([`NONE`] in a free slot).
    pub links: Vec<[u32; 3]>,
    /// Bit `k` says that edge `k` is constrained; both sides of an edge agree.
    pub constrained: Vec<u8>,
}

impl GhostMesh {
    /// A mesh of free slots.
    pub fn with_slots(slots: usize) -> Self {
        Self { triangles: vec![[DELETED; 3]; slots], links: vec![[NONE; 3]; slots], constrained: vec![0; slots] }
    }

    /// The number of slots, free ones included.
    pub fn slots(&self) -> usize {
        self.triangles.len()
    }

    /// Whether a slot holds no triangle.
    #[inline]
    pub fn is_deleted(&self, t: usize) -> bool {
        self.triangles[t][0] == DELETED
    }

    /// Whether a triangle has the ghost vertex as a corner.
    #[inline]
    pub fn is_ghost(&self, t: usize) -> bool {
        self.triangles[t].contains(&GHOST)
    }

    /// Whether a slot holds a triangle of three finite vertices.
    #[inline]
    pub fn is_finite(&self, t: usize) -> bool {
        self.triangles[t].iter().all(|&v| v < DELETED)
    }

    /// The slots of all finite triangles.
    pub fn finite(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.slots()).filter(|&t| self.is_finite(t))
    }

    /// The vertex where a half-edge starts.
    #[inline]
    pub fn origin(&self, h: u32) -> u32 {
        self.apex(next(h))
    }

    /// The vertex where a half-edge ends.
    #[inline]
    pub fn destination(&self, h: u32) -> u32 {
        self.apex(prev(h))
    }

    /// The corner opposite a half-edge.
    #[inline]
    pub fn apex(&self, h: u32) -> u32 {
        let (t, k) = twin_code(h);
        self.triangles[t][k]
    }

    /// The half-edge on the other side.
    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        let (t, k) = twin_code(h);
        self.links[t][k]
    }

    /// Makes two half-edges each other's other side.
    #[inline]
    pub fn link(&mut self, g: u32, h: u32) {
        let (t, k) = twin_code(g);
        let (u, j) = twin_code(h);
        self.links[t][k] = h;
        self.links[u][j] = g;
    }

    /// Whether an edge is constrained.
    #[inline]
    pub fn is_constrained(&self, h: u32) -> bool {
        let (t, k) = twin_code(h);
        self.constrained[t] >> k & 1 == 1
    }

    /// Marks or unmarks an edge as constrained, on both sides.
    pub fn set_constrained(&mut self, h: u32, yes: bool) {
        for side in [h, self.twin(h)] {
            let (t, k) = twin_code(side);
            self.constrained[t] = self.constrained[t] & !(1 << k) | u8::from(yes) << k;
        }
    }

    /// The next half-edge out of the same origin, counterclockwise.
    #[inline]
    pub fn rotate_ccw(&self, h: u32) -> u32 {
        self.twin(prev(h))
    }

    /// The next half-edge out of the same origin, clockwise.
    #[inline]
    pub fn rotate_cw(&self, h: u32) -> u32 {
        next(self.twin(h))
    }

    /// Frees a slot.
    pub fn delete(&mut self, t: usize) {
        self.triangles[t] = [DELETED; 3];
        self.links[t] = [NONE; 3];
        self.constrained[t] = 0;
    }

    /// Replaces the edge `ab` of half-edge `h = 3t + k` by the other diagonal `dc` of its two triangles, where
    /// `c` is the apex of `h` and `d` that of its twin `3u + j`.
    ///
    /// Afterwards `t` has the corners `c, a, d` at `k, k+1, k+2`, `u` has `d, b, c` at `j, j+1, j+2`, and the new
    /// edge is edge `k+1` of `t` (from `d` to `c`) and edge `j+1` of `u`. Returns the half-edge of the new edge in
    /// `t`. The new edge is not constrained; the four outer edges keep their marks. Topology only: the caller has
    /// made sure that the flip is legal, and that `c` and `d` differ.
    pub fn flip(&mut self, h: u32) -> u32 {
        let g = self.twin(h);
        let (t, k) = twin_code(h);
        let (u, j) = twin_code(g);
        let (h1, g1) = (next(h), next(g));
        let (t_outer, u_outer) = (self.twin(h1), self.twin(g1));
        let (t_bit, u_bit) = (self.is_constrained(h1), self.is_constrained(g1));
        let (c, d) = (self.triangles[t][k], self.triangles[u][j]);
        debug_assert!(c != d, "flipping an edge whose two apexes are one vertex");
        self.triangles[t][(k + 2) % 3] = d;
        self.triangles[u][(j + 2) % 3] = c;
        self.link(h, u_outer);
        self.link(g, t_outer);
        self.link(h1, g1);
        let bits = |bits: u8, a: usize, on: bool| bits & !(1 << a | 1 << ((a + 1) % 3)) | u8::from(on) << a;
        self.constrained[t] = bits(self.constrained[t], k, u_bit);
        self.constrained[u] = bits(self.constrained[u], j, t_bit);
        h1
    }

    /// For each of `vertices` vertices, one half-edge that starts there, or [`NONE`]: the lowest.
    pub fn half_edge_of_vertex(&self, vertices: usize) -> Vec<u32> {
        let mut out = vec![NONE; vertices];
        for h in 0..3 * self.slots() as u32 {
            if let Some(slot) = out.get_mut(self.origin(h) as usize) {
                *slot = (*slot).min(h);
            }
        }
        out
    }

    /// Moves the triangles together so that no slot is free; their order is kept.
    pub fn compact(&mut self) {
        let mut new_slot = vec![NONE; self.slots()];
        let mut used = 0;
        for (t, slot) in new_slot.iter_mut().enumerate() {
            if !self.is_deleted(t) {
                *slot = used as u32;
                self.triangles[used] = self.triangles[t];
                self.links[used] = self.links[t];
                self.constrained[used] = self.constrained[t];
                used += 1;
            }
        }
        self.triangles.truncate(used);
        self.links.truncate(used);
        self.constrained.truncate(used);
        for link in self.links.iter_mut().flatten() {
            *link = 3 * new_slot[(*link / 3) as usize] + *link % 3;
        }
    }

    /// Checks the topology: links point both ways and join the same two vertices, both sides agree on constrained
    /// edges, ghost triangles have exactly one ghost corner, and free slots are linked to nothing.
    ///
    /// # Errors
    ///
    /// [`MeshError::Broken`] with the first triangle at fault.
    pub fn check(&self) -> Result<(), MeshError> {
        let broken = |triangle: usize, what: &'static str| Err(MeshError::Broken { triangle, what });
        if self.links.len() != self.slots() || self.constrained.len() != self.slots() {
            return broken(self.slots(), "the arrays of the mesh differ in length");
        }
        for t in 0..self.slots() {
            let corners = self.triangles[t];
            if corners.contains(&DELETED) {
                if corners != [DELETED; 3] || self.links[t] != [NONE; 3] {
                    return broken(t, "a free slot with corners or links");
                }
                continue;
            }
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                return broken(t, "a vertex twice");
            }
            for k in 0..3 {
                let h = 3 * t as u32 + k;
                let g = self.twin(h);
                if g as usize >= 3 * self.slots() {
                    return broken(t, "a link that leads nowhere");
                }
                if self.twin(g) != h {
                    return broken(t, "a link that does not lead back");
                }
                if self.origin(h) != self.destination(g) || self.destination(h) != self.origin(g) {
                    return broken(t, "a link between different edges");
                }
                if self.is_constrained(h) != self.is_constrained(g) {
                    return broken(t, "an edge constrained on one side alone");
                }
            }
        }
        Ok(())
    }
}
