//! The inputs.

use polder_io::generate as make;
use polder_mesh::Pslg;
use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Input {
    Uniform,
    Gaussian,
    Clusters,
    Segments,
    Lattice,
    Circle,
    NearCollinear,
    NoisyLine,
}

impl Input {
    /// Where polder meets its peers.
    pub(crate) const PEERS: [Self; 4] = [Self::Uniform, Self::Gaussian, Self::Clusters, Self::Segments];

    /// What must not take much longer than a uniform input of the same size, and the share of the points it has.
    pub(crate) const DEGENERATE: [(Self, usize); 5] =
        [(Self::Lattice, 1), (Self::Circle, 10), (Self::NearCollinear, 1), (Self::NoisyLine, 1), (Self::Clusters, 1)];

    const ALL: [Self; 8] = [
        Self::Uniform,
        Self::Gaussian,
        Self::Clusters,
        Self::Segments,
        Self::Lattice,
        Self::Circle,
        Self::NearCollinear,
        Self::NoisyLine,
    ];

    pub(crate) fn parse(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|input| input.word() == name).ok_or_else(|| format!("no input is called {name}"))
    }

    /// A word for the command line.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Gaussian => "gaussian",
            Self::Clusters => "clusters",
            Self::Segments => "segments",
            Self::Lattice => "lattice",
            Self::Circle => "circle",
            Self::NearCollinear => "near-collinear",
            Self::NoisyLine => "noisy-line",
        }
    }

    /// What it is, for people.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Gaussian => "gaussian",
            Self::Clusters => "100 clusters, sigma 1e-4",
            Self::Segments => "long constraints, a tenth",
            Self::Lattice => "square lattice",
            Self::Circle => "circle",
            Self::NearCollinear => "a line but for one ulp",
            Self::NoisyLine => "a line with noise of 1e-6",
        }
    }

    pub(crate) fn make(self, points: usize) -> Pslg {
        const SEED: u64 = 1;
        let side = points.isqrt();
        match self {
            Self::Uniform => make::uniform(points, SEED),
            Self::Gaussian => make::gaussian(points, SEED),
            Self::Clusters => make::clusters(points, 100, 1e-4, SEED),
            Self::Segments => make::segments(points, points / 10, SEED),
            Self::Lattice => make::lattice(side, side),
            Self::Circle => make::circle(points, SEED),
            Self::NearCollinear => make::near_collinear(points, 1, SEED),
            Self::NoisyLine => make::noisy_line(points, 1e-6, SEED),
        }
    }
}
