use crate::Crossings;
use polder_flip::FlipError;
use thiserror::Error;

/// Why constraints could not be inserted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ConstrainError {
    /// An end of a constraint is not a vertex of the mesh.
    #[error("constraint {constraint}: its end {vertex} is not a vertex of the mesh")]
    NotAVertex {
        /// Index of the first such constraint.
        constraint: usize,
        /// The end.
        vertex: u32,
    },
    /// A corner of the mesh has no position.
    #[error("triangle {triangle}: its corner {vertex} has no position, there are only {positions}")]
    MissingPosition {
        /// The first triangle with such a corner.
        triangle: usize,
        /// The corner.
        vertex: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// The chains of all constraints together have more vertices than 32-bit ids can number.
    #[error("constraint {constraint}: up to it the chains have {count} vertices, at most {limit} are possible")]
    TooLarge {
        /// The constraint at which the limit was passed.
        constraint: usize,
        /// How many vertices there were.
        count: usize,
        /// The most that are possible.
        limit: usize,
    },
    /// More sub-constraints than can be told apart in the word of a triangle.
    #[error("{count} sub-constraints; at most {limit} are possible")]
    TooMany {
        /// How many there are.
        count: usize,
        /// The most that are possible.
        limit: usize,
    },
    /// Constraints cross each other where no vertex is.
    #[error("{}", describe(.0))]
    CrossingConstraints(Crossings),
    /// A sub-constraint crosses an edge that is constrained already.
    #[error("the sub-constraint {} - {} crosses the constrained edge {} - {}", .sub_constraint[0], .sub_constraint[1], .edge[0], .edge[1])]
    Blocked {
        /// Its two vertices.
        sub_constraint: [u32; 2],
        /// The two vertices of the edge.
        edge: [u32; 2],
    },
    /// A sub-constraint runs through a vertex: it should have been cut there.
    #[error("the sub-constraint {} - {} runs through vertex {vertex}", .sub_constraint[0], .sub_constraint[1])]
    ThroughVertex {
        /// Its two vertices.
        sub_constraint: [u32; 2],
        /// The vertex between them.
        vertex: u32,
    },
    /// A walk along a line left the mesh or went in circles: the mesh is not a triangulation with a convex hull.
    #[error("the walk from vertex {} to {} lost its way: the mesh is not a triangulation of a convex hull", .ends[0], .ends[1])]
    Lost {
        /// Where the walk came from and went to.
        ends: [u32; 2],
    },
    /// The same on a device, which knows the constraint.
    #[error("constraint {constraint}: its walk lost its way: the mesh is not a triangulation of a convex hull")]
    WalkLost {
        /// The lowest constraint that was lost.
        constraint: u32,
    },
    /// On a device, constraints met more vertices between their ends than there is room for.
    #[error("constraints meet {needed} vertices between their ends; there is room for {room}")]
    TooManyStops {
        /// Room for so many would do.
        needed: u32,
        /// Room that there was.
        room: u32,
    },
    /// The bound on rounds was reached, or a round changed nothing: the mesh was not a triangulation.
    #[error("constrain: {remaining} sub-constraints are still missing after {rounds} rounds")]
    BoundExceeded {
        /// How many outer rounds were made.
        rounds: u64,
        /// How many sub-constraints are not in yet.
        remaining: usize,
    },
    /// The flips after the insertion.
    #[error(transparent)]
    Flip(#[from] FlipError),
}

fn describe(crossings: &Crossings) -> String {
    let more = if crossings.truncated { "more than " } else { "" };
    let first = crossings.pairs.first().map(|[i, j]| format!(", the first are {i} and {j}")).unwrap_or_default();
    format!("{more}{} pairs of constraints cross{first}", crossings.pairs.len())
}
