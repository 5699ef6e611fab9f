use std::fmt;

/// What an insertion did and cost.
///
/// The text form is one line, for instance `4 sub-constraints (1 an edge already), 30 intersections, 2 outer and 9
/// inner rounds, 0 chains rebuilt, flips 20 + 1 + 3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InsertReport {
    /// Sub-constraints, all of which are constrained edges now.
    pub sub_constraints: u64,
    /// Those that were edges before the first flip.
    pub edges_already: u64,
    /// Pairs of a sub-constraint and a triangle that it crosses, before the first flip. Nothing where there are hubs, since not
    /// all that begin there walk then; [`Walk::intersections`](crate::Walk::intersections) knows.
    pub intersections: Option<u64>,
    /// Triangles visited by the walks of all outer rounds.
    pub walked: u64,
    /// Outer rounds.
    pub outer_rounds: u64,
    /// Inner rounds, of all outer rounds together.
    pub inner_rounds: u64,
    /// Sub-constraints that were inserted by rebuilding the triangles of their chains.
    pub rebuilt: u64,
    /// Flips by case 1, 2 and 3, for the others.
    pub flips: [u64; 3],
}

impl InsertReport {
    /// Flips of all cases.
    pub fn all_flips(&self) -> u64 {
        self.flips.iter().sum()
    }
}

impl fmt::Display for InsertReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, two, three] = self.flips;
        write!(f, "{} sub-constraints ({} edges already), ", self.sub_constraints, self.edges_already)?;
        if let Some(intersections) = self.intersections {
            write!(f, "{intersections} intersections, ")?;
        }
        write!(f, "{} outer and ", self.outer_rounds)?;
        write!(f, "{} inner rounds, {} chains rebuilt, flips {one} + {two} + {three}", self.inner_rounds, self.rebuilt)
    }
}

/// Why an insertion came to no good end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The lowest sub-constraint, of those that came so far, that met a constrained edge.
    Blocked(u32),
    /// The lowest one that ran through a vertex.
    ThroughVertex(u32),
    /// The lowest one whose walk left the mesh: that is not a triangulation of a convex hull.
    Lost(u32),
    /// A round changed nothing: the mesh was not a triangulation.
    Stuck,
}
