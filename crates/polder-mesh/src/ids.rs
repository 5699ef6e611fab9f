use bytemuck::{Pod, Zeroable};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as an index into a slice.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<u32> for $name {
            fn from(id: u32) -> Self {
                Self(id)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

id! {
    /// A vertex: the index of an input point, the lowest among equal ones.
    VertexId
}
id! {
    /// A triangle: its place in the canonical order.
    TriangleId
}
id! {
    /// An edge as seen from one of its triangles: `3 * triangle + k`, the edge opposite corner `k`.
    EdgeId
}
id! {
    /// A constraint: its index in the input.
    ConstraintId
}

impl EdgeId {
    /// The edge opposite corner `k` of a triangle, `k < 3`.
    pub fn of(triangle: TriangleId, k: usize) -> Self {
        Self(3 * triangle.0 + k as u32)
    }

    /// The triangle on the left of this edge.
    pub fn triangle(self) -> TriangleId {
        TriangleId(self.0 / 3)
    }

    /// Which of the triangle's edges this is, 0 to 2.
    pub fn k(self) -> usize {
        self.0 as usize % 3
    }
}
