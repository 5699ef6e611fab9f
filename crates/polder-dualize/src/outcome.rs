//! What the stages give, each with a stable text form: first a line or two of counts, then the mesh.

use crate::reference::elect;
use polder_flip::FlipReport;
use polder_mesh::GhostMesh;
use std::fmt;

/// What [`reference::dual`](crate::reference::dual) and [`reference::dualize`](crate::reference::dualize) give.
///
/// Text form: the counts in one line, then the mesh, one triangle a line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dualized {
    /// The triangulation of the sites at their pixels, by site number. No slot is free.
    pub mesh: GhostMesh,
    /// Necks: corners of the grid with three colors that are no vertices.
    pub necks: u64,
    /// Finite triangles before the hull was closed.
    pub open: usize,
    /// The ghost flips that closed it, if it is closed.
    pub hull: FlipReport,
}

/// What [`reference::shift`](crate::reference::shift) gives.
///
/// Text form: the counts in two lines, a line `1 -> 4, 7 -> 4` of the sites taken out with their heirs (`-` for none)
/// if there are any, then the mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shifted {
    /// The triangulation of the sites that are left, at their true positions. It has as many slots as the dualized mesh,
    /// or none: the slots of the triangles that went with the sites taken out are free.
    pub mesh: GhostMesh,
    /// For each site itself if it is a vertex, else a vertex close to where it was taken out. [`polder_mesh::NONE`]
    /// for all of them if the mesh is empty, which counts as all being taken out.
    pub heirs: Vec<u32>,
    /// For each site that was taken out the two slots that it left free; twice [`polder_mesh::NONE`] for a vertex, and
    /// for all sites if the mesh is empty.
    pub freed: Vec<[u32; 2]>,
    /// Sites pinned in the first step.
    pub bad: usize,
    /// Those of them that the second step could not free.
    pub stuck: usize,
    /// Rounds of pinning, of unpinning, of taking out.
    pub rounds: [u64; 3],
    /// The ghost flips.
    pub hull: FlipReport,
}

impl Shifted {
    /// The sites that were taken out, ascending, each with its heir.
    pub fn taken_out(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        (0..).zip(&self.heirs).filter(|(site, heir)| site != *heir).map(|(site, &heir)| (site, heir))
    }
}

/// What [`reference::insert`](crate::reference::insert) gives.
///
/// Text form: the counts in two lines, a line `9 = 2, 11 = 2` of the points equal to a vertex if there are any, then the
/// mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inserted {
    /// The triangulation of all distinct points. The slots of points equal to a vertex are free.
    pub mesh: GhostMesh,
    /// For each point the vertex that it is or equals.
    pub vertex_of: Vec<u32>,
    /// Rounds of insertion.
    pub rounds: u64,
    /// Points that the rounds inserted.
    pub inserted: u64,
    /// Points that were found equal to a vertex.
    pub duplicates: u64,
    /// Whether there was no finite triangle to start from.
    pub bootstrapped: bool,
    /// Steps of all walks to a container: orientation tests.
    pub steps: u64,
    /// Steps of all searches for a sector outside the hull: hull edges.
    pub sector_steps: u64,
    /// All ghost flips.
    pub hull: FlipReport,
    /// The flip rounds between insertion rounds.
    pub flips: FlipReport,
}

impl Inserted {
    /// For each vertex the lowest input index of the points that it stands for; `order` gives the input index of each
    /// point, as [`Sites::order`](polder_voronoi::Sites) does. Names of points that are no vertices mean nothing.
    pub fn names(&self, order: &[u32]) -> Vec<u32> {
        elect::names(&self.vertex_of, order)
    }

    /// For each input point the name of the vertex that it is or equals; `names` as [`Self::names`] gives them.
    pub fn representatives(&self, order: &[u32], names: &[u32]) -> Vec<u32> {
        elect::representatives(&self.vertex_of, order, names)
    }
}

struct Finite<'a>(&'a GhostMesh);

impl fmt::Display for Finite<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ghosts = (0..self.0.slots()).filter(|&t| self.0.is_ghost(t)).count();
        write!(f, "{} triangles, {ghosts} ghosts", self.0.finite().count())
    }
}

/// `a SEP b, c SEP d` and the end of the line; nothing for no pairs.
fn pairs(f: &mut fmt::Formatter<'_>, separator: &str, pairs: impl Iterator<Item = (u32, u32)>) -> fmt::Result {
    let mut none = true;
    for (from, to) in pairs {
        let comma = if std::mem::take(&mut none) { "" } else { ", " };
        write!(f, "{comma}{from} {separator} ")?;
        if to == polder_mesh::NONE { write!(f, "-")? } else { write!(f, "{to}")? }
    }
    if none { Ok(()) } else { writeln!(f) }
}

impl fmt::Display for Dualized {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, {} before closing the hull, {} necks", Finite(&self.mesh), self.open, self.necks)?;
        self.mesh.fmt(f)
    }
}

impl fmt::Display for Shifted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [pin, unpin, out] = self.rounds;
        writeln!(f, "{}", Finite(&self.mesh))?;
        writeln!(
            f,
            "{} pinned, {} still after unpinning, rounds {pin} + {unpin} + {out}, {} hull flips",
            self.bad, self.stuck, self.hull.flips
        )?;
        pairs(f, "->", self.taken_out())?;
        self.mesh.fmt(f)
    }
}

impl fmt::Display for Inserted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = if self.bootstrapped { ", bootstrapped" } else { "" };
        writeln!(f, "{}{start}", Finite(&self.mesh))?;
        writeln!(
            f,
            "{} inserted, {} duplicates, {} rounds, {} hull flips, {} flips",
            self.inserted, self.duplicates, self.rounds, self.hull.flips, self.flips.flips
        )?;
        let equal = (0..).zip(&self.vertex_of).filter(|(i, v)| i != *v).map(|(i, &v)| (i, v));
        pairs(f, "=", equal)?;
        self.mesh.fmt(f)
    }
}
