use polder_mesh::Chains;
use std::fmt;

/// Constraints cut at the vertices they run through.
///
/// A *sub-constraint* is a pair of vertices with none between them; constraints that repeat or overlap share theirs.
/// Sub-constraints are numbered in the order of their vertices, so that the numbers do not depend on the order or the
/// direction of the constraints.
///
/// The text form lists the sub-constraints, `0: 2 - 5, crosses 4 edges` or `1: 2 - 7, an edge`, then for each
/// constraint its vertices and in brackets its sub-constraints: `constraint 0: 2 5 9 [0 3]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Walk {
    /// The two vertices of each sub-constraint, the lower one first; sorted, each once.
    pub sub_constraints: Vec<[u32; 2]>,
    /// How many edges of the walked mesh each sub-constraint crosses: none if it is an edge itself, else it crosses
    /// one triangle more than edges.
    pub crossed_edges: Vec<u32>,
    /// The vertices along each constraint; one vertex for a constraint of zero length.
    pub chains: Chains,
    /// For each sub-constraint where it leaves the star of its lower vertex in the walked mesh: the half-edge opposite
    /// that vertex that it crosses first, or, if it is an edge, the half-edge from its lower vertex to its higher one.
    pub(crate) departures: Vec<u32>,
    /// The sub-constraints along all constraints in turn, and where each constraint's begin.
    pub(crate) pieces: Vec<u32>,
    pub(crate) piece_offsets: Vec<u32>,
}

impl Walk {
    /// The sub-constraints along constraint `i`, from its first end to its second.
    pub fn pieces(&self, i: usize) -> &[u32] {
        &self.pieces[self.piece_offsets[i] as usize..self.piece_offsets[i + 1] as usize]
    }

    /// How many pairs of a sub-constraint and a triangle there are where the one runs through the other's interior.
    pub fn intersections(&self) -> u64 {
        self.crossed_edges.iter().map(|&edges| u64::from(edges) + u64::from(edges > 0)).sum()
    }
}

impl fmt::Display for Walk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (s, ([a, b], edges)) in self.sub_constraints.iter().zip(&self.crossed_edges).enumerate() {
            match edges {
                0 => writeln!(f, "{s}: {a} - {b}, an edge")?,
                1 => writeln!(f, "{s}: {a} - {b}, crosses 1 edge")?,
                _ => writeln!(f, "{s}: {a} - {b}, crosses {edges} edges")?,
            }
        }
        for (i, chain) in self.chains.iter().enumerate() {
            write!(f, "constraint {i}:")?;
            chain.iter().try_for_each(|v| write!(f, " {v}"))?;
            let pieces: Vec<String> = self.pieces(i).iter().map(u32::to_string).collect();
            writeln!(f, " [{}]", pieces.join(" "))?;
        }
        Ok(())
    }
}
