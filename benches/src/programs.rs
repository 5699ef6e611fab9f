//! The programs that are compared.

use crate::machine::cores;
use polder::{Backend, Options};
use polder_mesh::{Pslg, Triangulation};
use spade::{ConstrainedDelaunayTriangulation, DelaunayTriangulation, Point2, Triangulation as _};
use std::time::Instant;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Program {
    /// Ours, with so many threads.
    Polder(usize),
    Spade,
    Delaunator,
}

/// The input as a program wants it, with what it consumes copied in advance.
pub(crate) enum Prepared<'a> {
    Polder(&'a Pslg, Options),
    Spade(Vec<Point2<f64>>, Vec<[usize; 2]>),
    Delaunator(Vec<delaunator::Point>),
}

/// What a program made of it; it is freed after the clock has stopped.
pub(crate) enum Made {
    Polder(Triangulation),
    Spade(DelaunayTriangulation<Point2<f64>>),
    SpadeConstrained(ConstrainedDelaunayTriangulation<Point2<f64>>),
    Delaunator(delaunator::Triangulation),
}

impl Program {
    /// Ours with one thread and with all cores, and the others, which use one.
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::Polder(1)];
        if cores() > 1 {
            all.push(Self::Polder(cores()));
        }
        all.extend([Self::Spade, Self::Delaunator]);
        all
    }

    pub(crate) fn name(self) -> String {
        match self {
            Self::Polder(threads) => format!("polder-{threads}"),
            Self::Spade => "spade".into(),
            Self::Delaunator => "delaunator".into(),
        }
    }

    pub(crate) fn parse(name: &str) -> Result<Self, String> {
        let threads = name.strip_prefix("polder-").and_then(|threads| threads.parse().ok());
        match (name, threads) {
            (_, Some(threads)) => Ok(Self::Polder(threads)),
            ("spade", _) => Ok(Self::Spade),
            ("delaunator", _) => Ok(Self::Delaunator),
            _ => Err(format!("no program is called {name}")),
        }
    }

    /// Whether it can do this at all.
    pub(crate) fn takes(self, pslg: &Pslg) -> bool {
        self != Self::Delaunator || pslg.constraints().is_empty()
    }

    pub(crate) fn prepare(self, pslg: &Pslg) -> Prepared<'_> {
        match self {
            Self::Polder(threads) => {
                let mut options = Options::with_backend(Backend::Cpu);
                options.threads = threads;
                Prepared::Polder(pslg, options)
            }
            Self::Spade => Prepared::Spade(
                pslg.points().iter().map(|p| Point2::new(p.x, p.y)).collect(),
                pslg.constraints().iter().map(|c| c.map(|v| v as usize)).collect(),
            ),
            Self::Delaunator => {
                Prepared::Delaunator(pslg.points().iter().map(|p| delaunator::Point { x: p.x, y: p.y }).collect())
            }
        }
    }
}

impl Prepared<'_> {
    /// Runs the program; gives the seconds it took and what it made.
    pub(crate) fn run(self) -> Result<(f64, Made), String> {
        let start = Instant::now();
        let made = match self {
            Self::Polder(pslg, options) => {
                Made::Polder(polder::triangulate(pslg, &options).map_err(|error| error.to_string())?.triangulation)
            }
            // Its fastest way, which renumbers the points; the one that keeps the numbering takes about twice as long.
            Self::Spade(points, constraints) if constraints.is_empty() => {
                Made::Spade(DelaunayTriangulation::bulk_load(points).map_err(|error| error.to_string())?)
            }
            Self::Spade(points, constraints) => Made::SpadeConstrained(
                ConstrainedDelaunayTriangulation::bulk_load_cdt(points, constraints)
                    .map_err(|error| error.to_string())?,
            ),
            Self::Delaunator(points) => Made::Delaunator(delaunator::triangulate(&points)),
        };
        Ok((start.elapsed().as_secs_f64(), made))
    }
}

impl Made {
    pub(crate) fn triangles(&self) -> usize {
        match self {
            Self::Polder(mesh) => mesh.triangles().len(),
            Self::Spade(mesh) => mesh.num_inner_faces(),
            Self::SpadeConstrained(mesh) => mesh.num_inner_faces(),
            Self::Delaunator(mesh) => mesh.len(),
        }
    }
}
