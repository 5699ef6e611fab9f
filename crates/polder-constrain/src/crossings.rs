use std::fmt;

/// The pairs of constraints that cross properly: at a point that is no vertex and inside both.
///
/// Constraints that meet at a vertex, or that overlap, do not cross properly. Where a constraint crosses several that
/// overlap or repeat, each of them makes a pair.
///
/// The text form has one line a pair, `3 x 7`, and a last line `...` if there are more.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of constraints, the lower one first, sorted, each once.
    pub pairs: Vec<[u32; 2]>,
    /// Whether there are more pairs than were asked for. The ones listed are then the first ones in the order of
    /// their higher constraint, and of the lower one where that is the same: a choice that depends on the constraints
    /// alone, not on the mesh.
    pub truncated: bool,
}

impl fmt::Display for Crossings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.pairs.iter().try_for_each(|[i, j]| writeln!(f, "{i} x {j}"))?;
        if self.truncated { writeln!(f, "...") } else { Ok(()) }
    }
}
