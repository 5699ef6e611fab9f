use thiserror::Error;

/// What can be wrong with the mesh: each a defect of the stages before.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CanonicalError {
    /// A link leads to an edge that does not lead back, that has other ends, or that is constrained on one side alone.
    #[error("slot {triangle}: a link that does not lead back")]
    Broken {
        /// The lowest slot at fault.
        triangle: u32,
    },
    /// A finite triangle is not strictly counterclockwise.
    #[error("slot {triangle}: the triangle is not counterclockwise")]
    NotCounterclockwise {
        /// The lowest slot at fault.
        triangle: u32,
    },
    /// The hull turns right, or folds back, at the end of a hull edge.
    #[error("slot {triangle}: the hull is not convex at the end of this ghost triangle's edge")]
    HullNotConvex {
        /// The lowest slot at fault.
        triangle: u32,
    },
    /// The hull has not one lexicographically lowest corner.
    #[error("the hull winds round {times} times")]
    HullWinds {
        /// How many it has.
        times: u32,
    },
    /// The numbers of triangles and vertices are not those of a sphere.
    #[error("{triangles} triangles, ghosts included, for {vertices} vertices")]
    Count {
        /// Triangles.
        triangles: u64,
        /// Vertices.
        vertices: u32,
    },
}
