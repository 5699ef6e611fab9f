//! What the checker says.

use polder_mesh::Pslg;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// At most so many problems of each kind are listed; all are counted.
pub const LISTED: usize = 16;

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)*) => {
        /// What can be wrong with a mesh.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum Kind { $($(#[$doc])* $name,)* }

        impl Kind {
            /// Every kind, in the order in which they are checked and listed.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// What is wrong, in a few words that follow the place.
            pub fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }
        }
    };
}

kinds! {
    /// More triangles than 32-bit edge numbers can count; nothing else is checked then.
    TooManyTriangles = "more triangles than can be numbered",
    /// A corner is not the index of a point.
    OutOfRange = "a corner is no point of the input",
    /// A triangle has the same point, or two equal points, twice.
    RepeatedCorner = "two of its corners are the same point",
    /// The corners of a triangle lie on one line.
    Flat = "its corners lie on one line",
    /// A triangle is clockwise where others are counterclockwise.
    Clockwise = "it is clockwise",
    /// Every triangle is clockwise; the mesh is read the other way round for all other checks.
    WhollyClockwise = "every triangle is clockwise",
    /// A triangle is there twice.
    RepeatedTriangle = "the second repeats the first",
    /// An edge has two or more triangles on one side.
    CrowdedEdge = "it has more than one triangle on one side",
    /// The triangles around a vertex are not one fan.
    PinchedVertex = "the triangles around it do not form one fan",
    /// No triangle, although the points do not lie on one line.
    Empty = "there is no triangle, although the points do not lie on one line",
    /// A point is no vertex, nor is any point equal to it.
    UnusedPoint = "it is not used, nor is any point equal to it",
    /// Two equal points are both vertices.
    TwoNames = "it and a point equal to it are both used",
    /// The boundary turns right, or back, at a vertex: something is missing there.
    Notch = "the boundary is not convex there",
    /// A second boundary, clockwise, begins with this edge: something is missing inside, or a vertex lies in the middle
    /// of an edge.
    Hole = "a hole or slit begins with it",
    /// A second outer boundary begins with this edge: the mesh falls into pieces, or covers some places twice.
    Pieces = "a second outer boundary begins with it",
    /// The boundary winds round more than once: the triangles overlap.
    WindsTwice = "the boundary that begins with it winds round more than once",
    /// A constraint is not a chain of mesh edges; the vertex is the one from which no edge leads on.
    MissingConstraint = "no mesh edge leads on along it",
    /// An unconstrained inner edge with the fourth corner inside the circle of the other three.
    NotDelaunay = "it is not locally Delaunay",
    /// Four cocircular corners with the other diagonal than the canonical one. The mesh is valid all the same.
    OtherDiagonal = "of two equally good diagonals it is not the canonical one",
    /// A corner is a point that equals a lower one. The mesh is valid all the same.
    HigherName = "a corner equals a point with a lower index",
    /// A triangle does not start at its smallest corner. The mesh is valid all the same.
    NotSmallestFirst = "it does not start at its smallest corner",
    /// A triangle comes after a greater one. The mesh is valid all the same.
    NotSorted = "it should come before the one before it",
    /// A triangulation's representative of a point is not the lowest point equal to it.
    WrongRepresentative = "its representative is not the lowest point equal to it",
    /// A triangulation's neighbor across an edge is not the triangle that lies there.
    WrongNeighbor = "the neighbor noted across it is not the triangle that lies there",
    /// A triangulation's constrained bit of an edge is set without a constraint, or not set in spite of one.
    WrongConstrainedBit = "its constrained bit does not agree with the constraints",
    /// A triangulation's chain of a constraint does not run along it from vertex to vertex.
    WrongChain = "the chain noted for it is not the vertices along it",
}

impl Kind {
    /// Whether a mesh with such a problem is still a constrained Delaunay triangulation, though not the canonical one.
    pub fn is_harmless(self) -> bool {
        matches!(self, Self::OtherDiagonal | Self::HigherName | Self::NotSmallestFirst | Self::NotSorted)
    }
}

/// Where a problem is. Indices are those of the input and of the mesh as given; of equal points, the lowest stands
/// for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// The mesh as a whole.
    Mesh,
    /// A triangle.
    Triangle(u32),
    /// Two triangles, the lower one first.
    Triangles([u32; 2]),
    /// An edge: its two ends, and a triangle that has it (on its left, as it runs from the first end to the second).
    Edge {
        /// From where to where it runs.
        ends: [u32; 2],
        /// The triangle on its left.
        triangle: u32,
    },
    /// A vertex or point.
    Point(u32),
    /// A constraint, and the last vertex along it that was reached.
    Constraint {
        /// Its index.
        constraint: u32,
        /// The vertex.
        vertex: u32,
    },
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh => write!(f, "mesh"),
            Self::Triangle(t) => write!(f, "triangle {t}"),
            Self::Triangles([t, u]) => write!(f, "triangles {t} and {u}"),
            Self::Edge { ends: [a, b], triangle } => write!(f, "edge {a}-{b} of triangle {triangle}"),
            Self::Point(v) => write!(f, "point {v}"),
            Self::Constraint { constraint, vertex } => write!(f, "constraint {constraint} at point {vertex}"),
        }
    }
}

/// One thing that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Problem {
    /// What.
    pub kind: Kind,
    /// Where.
    pub place: Place,
}

impl Display for Problem {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.kind.text())
    }
}

/// What the checker found.
///
/// Its text form (`Display`) is one line with the sum, then one line for each listed problem.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Verdict {
    points: usize,
    constraints: usize,
    triangles: usize,
    valid: bool,
    canonical: bool,
    problems: Vec<Problem>,
    totals: Vec<(Kind, u64)>,
}

impl Verdict {
    pub(super) fn new(pslg: &Pslg, triangles: usize, found: Found) -> Self {
        let totals: Vec<_> = Kind::ALL.iter().map(|&kind| (kind, found.total(kind))).filter(|t| t.1 > 0).collect();
        let mut problems = found.listed;
        problems.sort_by_key(|problem| problem.kind);
        Self {
            points: pslg.points().len(),
            constraints: pslg.constraints().len(),
            triangles,
            valid: totals.iter().all(|(kind, _)| kind.is_harmless()),
            canonical: totals.is_empty(),
            problems,
            totals,
        }
    }

    /// Whether the mesh is a constrained Delaunay triangulation of its input, canonical or not.
    pub fn is_valid(&self) -> bool {
        self.valid
    }

    /// Whether the mesh is valid, and the canonical one: triangle by triangle, in canonical order.
    pub fn is_canonical(&self) -> bool {
        self.canonical
    }

    /// The problems, by kind in the order of checking, at most [`LISTED`] of each kind; those that only speak
    /// against being canonical included.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// How many problems of each kind there are; kinds without one are left out.
    pub fn totals(&self) -> &[(Kind, u64)] {
        &self.totals
    }

    /// How many problems of one kind there are.
    pub fn total(&self, kind: Kind) -> u64 {
        self.totals.iter().find(|total| total.0 == kind).map_or(0, |total| total.1)
    }
}

impl Display for Verdict {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let word = match (self.valid, self.canonical) {
            (_, true) => "valid and canonical",
            (true, false) => "valid, but not canonical",
            (false, _) => "not valid",
        };
        write!(f, "{word}: {} triangles, {} points, {} constraints", self.triangles, self.points, self.constraints)?;
        for &(kind, total) in &self.totals {
            let listed = self.problems.iter().filter(|problem| problem.kind == kind);
            listed.clone().try_for_each(|problem| write!(f, "\n  {problem}"))?;
            match total - listed.count() as u64 {
                0 => {}
                more => write!(f, "\n  and {more} more like this")?,
            }
        }
        Ok(())
    }
}

/// Problems on their way into a verdict.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    listed: Vec<Problem>,
    totals: Vec<u64>,
    /// Whether a sound triangle has a corner that is not the representative of its equals.
    pub(super) renamed: bool,
}

impl Found {
    /// Drops what was found of one kind.
    pub(super) fn forget(&mut self, kind: Kind) {
        self.listed.retain(|problem| problem.kind != kind);
        if let Some(total) = self.totals.get_mut(kind as usize) {
            *total = 0;
        }
    }

    pub(super) fn total(&self, kind: Kind) -> u64 {
        self.totals.get(kind as usize).copied().unwrap_or(0)
    }

    pub(super) fn add(&mut self, kind: Kind, place: Place) {
        self.totals.resize(Kind::ALL.len(), 0);
        self.totals[kind as usize] += 1;
        if self.totals[kind as usize] <= LISTED as u64 {
            self.listed.push(Problem { kind, place });
        }
    }

    /// Takes over what was found after this.
    pub(super) fn append(&mut self, later: Self) {
        self.renamed |= later.renamed;
        if later.totals.is_empty() {
            return;
        }
        self.totals.resize(Kind::ALL.len(), 0);
        let before = self.totals.clone();
        self.totals.iter_mut().zip(&later.totals).for_each(|(sum, more)| *sum += more);
        let mut room: Vec<_> = before.iter().map(|&total| LISTED.saturating_sub(total as usize)).collect();
        self.listed.extend(later.listed.into_iter().filter(|problem| {
            let room = &mut room[problem.kind as usize];
            let fits = *room > 0;
            *room -= usize::from(fits);
            fits
        }));
    }

    /// Looks at ranges of `0..len` side by side; what they find comes in the order of the ranges.
    pub(super) fn sweep(&mut self, len: usize, look: impl Fn(Range<usize>, &mut Self) + Sync) {
        const RANGE: usize = 1 << 15;
        let all: Vec<_> = (0..len.div_ceil(RANGE))
            .into_par_iter()
            .map(|i| {
                let mut found = Self::default();
                look(i * RANGE..len.min((i + 1) * RANGE), &mut found);
                found
            })
            .collect();
        all.into_iter().for_each(|found| self.append(found));
    }
}
