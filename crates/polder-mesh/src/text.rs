//! The readable text forms, for snapshots and for people.

use crate::{Chains, GHOST, GhostMesh, NONE, Triangulation};
use std::fmt::{Display, Formatter, Result};

struct Corner(u32);

impl Display for Corner {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if self.0 == GHOST { f.pad("*") } else { Display::fmt(&self.0, f) }
    }
}

impl Display for GhostMesh {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for t in (0..self.slots()).filter(|&t| !self.is_deleted(t)) {
            let [a, b, c] = self.triangles[t].map(Corner);
            write!(f, "{t}: {a} {b} {c} |")?;
            for k in 0..3 {
                let h = 3 * t as u32 + k;
                let mark = if self.is_constrained(h) { "!" } else { "" };
                write!(f, " {mark}{}.{}", self.twin(h) / 3, self.twin(h) % 3)?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// One triangle a line: its index, corners and neighbors (`-` for none, `!` before a neighbor across a constrained
/// edge); then a line for each duplicate point and each constraint's chain.
impl Display for Triangulation {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for (t, ([a, b, c], neighbors)) in self.triangles().iter().zip(self.neighbors()).enumerate() {
            write!(f, "{t}: {a} {b} {c} |")?;
            for (k, &neighbor) in neighbors.iter().enumerate() {
                let mark = if self.constrained_bits()[t] >> k & 1 == 1 { "!" } else { "" };
                if neighbor == NONE { write!(f, " {mark}-")? } else { write!(f, " {mark}{neighbor}")? }
            }
            writeln!(f)?;
        }
        for (point, of) in self.duplicates() {
            writeln!(f, "point {point} = {of}")?;
        }
        Display::fmt(self.chains(), f)
    }
}

/// One line a constraint: its index and the vertices along it.
impl Display for Chains {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for (i, chain) in self.iter().enumerate() {
            write!(f, "constraint {i}:")?;
            chain.iter().try_for_each(|v| write!(f, " {v}"))?;
            writeln!(f)?;
        }
        Ok(())
    }
}
