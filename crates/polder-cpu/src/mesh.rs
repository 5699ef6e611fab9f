//! The backend's own working mesh: triangles of 32 bytes, half-edges `4t + k`.

/// No half-edge, no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// Corners and links of a triangle. The fourth corner holds the marks: bit `k` says that edge `k` is constrained.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Tri {
    pub(crate) v: [u32; 4],
    pub(crate) n: [u32; 4],
}

impl Tri {
    pub(crate) const EMPTY: Self = Self { v: [NONE, NONE, NONE, 0], n: [NONE; 4] };
}

/// The index among `u32; 4` that a half-edge stands for.
#[inline(always)]
pub(crate) const fn k(h: u32) -> usize {
    (h & 3) as usize
}

/// The next half-edge of the same triangle, counterclockwise.
#[inline(always)]
pub(crate) const fn next(h: u32) -> u32 {
    if h & 3 == 2 { h - 2 } else { h + 1 }
}

/// The previous half-edge of the same triangle.
#[inline(always)]
pub(crate) const fn prev(h: u32) -> u32 {
    if h & 3 == 0 { h + 2 } else { h - 1 }
}

/// A run of triangles of the whole mesh: the ones that belong to a run of vertices.
///
/// Ids are those of the whole mesh, so that parts built by different threads need no renaming.
pub(crate) struct Slab<'a> {
    pub(crate) tris: &'a mut [Tri],
    /// The id of the first triangle here.
    pub(crate) base: u32,
}

impl Slab<'_> {
    #[inline(always)]
    pub(crate) fn tri(&self, t: u32) -> &Tri {
        &self.tris[(t - self.base) as usize]
    }

    #[inline(always)]
    pub(crate) fn tri_mut(&mut self, t: u32) -> &mut Tri {
        &mut self.tris[(t - self.base) as usize]
    }

    #[inline(always)]
    pub(crate) fn twin(&self, h: u32) -> u32 {
        self.tri(h >> 2).n[k(h)]
    }

    #[inline(always)]
    pub(crate) fn apex(&self, h: u32) -> u32 {
        self.tri(h >> 2).v[k(h)]
    }

    #[inline(always)]
    pub(crate) fn origin(&self, h: u32) -> u32 {
        self.apex(next(h))
    }

    #[inline(always)]
    pub(crate) fn destination(&self, h: u32) -> u32 {
        self.apex(prev(h))
    }

    /// Sets one direction of a link.
    #[inline(always)]
    pub(crate) fn set_twin(&mut self, h: u32, g: u32) {
        self.tri_mut(h >> 2).n[k(h)] = g;
    }

    /// Makes two half-edges each other's other side.
    #[inline(always)]
    pub(crate) fn link(&mut self, g: u32, h: u32) {
        self.set_twin(g, h);
        self.set_twin(h, g);
    }

    #[inline(always)]
    pub(crate) fn is_constrained(&self, h: u32) -> bool {
        self.tri(h >> 2).v[3] >> (h & 3) & 1 == 1
    }

    /// Marks an edge as constrained, on both sides. Returns whether it was not before.
    pub(crate) fn constrain(&mut self, h: u32) -> bool {
        let new = !self.is_constrained(h);
        for side in [h, self.twin(h)] {
            self.tri_mut(side >> 2).v[3] |= 1 << (side & 3);
        }
        new
    }

    /// Marks one side of an edge.
    pub(crate) fn set_mark(&mut self, h: u32, yes: bool) {
        let marks = &mut self.tri_mut(h >> 2).v[3];
        *marks = *marks & !(1 << (h & 3)) | u32::from(yes) << (h & 3);
    }
}
