use polder_canonical::CanonicalError;
use polder_constrain::ConstrainError;
use polder_dualize::DualizeError;
use polder_flip::FlipError;
use polder_mesh::{Cancelled, Chains, MeshError};
use polder_voronoi::VoronoiError;
use thiserror::Error;

/// Why there is no triangulation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The input breaks a rule of [`Pslg`](crate::Pslg).
    #[error(transparent)]
    Input(#[from] MeshError),
    /// Constraints cross each other at points inside both.
    #[error(
        "{}{} pairs of constraints cross, the first {} and {}",
        if *truncated { "more than " } else { "" },
        pairs.len(),
        pairs.first().map_or(0, |p| p[0]),
        pairs.first().map_or(0, |p| p[1])
    )]
    CrossingConstraints {
        /// The pairs, each with its lower constraint first, sorted.
        pairs: Vec<[u32; 2]>,
        /// Whether there are more than the pairs listed.
        truncated: bool,
    },
    /// A hole or label of a region does not say which region it means.
    #[error("seed {seed}: it lies on a constrained edge, between regions")]
    SeedOnConstraint {
        /// Index of the first such seed.
        seed: usize,
    },
    /// A coordinate of a hole or label of a region is NaN or infinite.
    #[error("seed {seed}: a coordinate is not a finite number")]
    SeedNotFinite {
        /// Index of the first such seed.
        seed: usize,
    },
    /// Cutting constraints where they cross made them cross again, round after round.
    #[error("constraints still cross after they were cut in {rounds} rounds")]
    SplitUnfinished {
        /// The rounds.
        rounds: u32,
    },
    /// Constraints cross more often than may be.
    #[error("more than {limit} {what}")]
    SplitTooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The most that may be.
        limit: usize,
    },
    /// What was asked for does not exist here.
    #[error("{what}")]
    Unsupported {
        /// What is missing, and what to do instead.
        what: String,
    },
    /// A loop ran past its proven bound: a defect of polder, caught before it could hang.
    #[error("stage {stage}: not done after {bound} rounds, its bound")]
    BoundExceeded {
        /// The stage whose loop it was.
        stage: &'static str,
        /// The bound.
        bound: u64,
    },
    /// An invariant does not hold: a defect of polder, caught before it could do harm.
    #[error("stage {stage}: {what}")]
    Internal {
        /// The stage that noticed.
        stage: &'static str,
        /// What does not hold.
        what: String,
    },
    /// The device's memory does not suffice; found out before any work, or when some of it was refused.
    #[error("{what}")]
    OutOfMemory {
        /// Bytes needed, and available.
        what: String,
    },
    /// The device was lost, or did not answer in time: open it anew.
    #[error("{what}")]
    DeviceLost {
        /// What happened.
        what: String,
    },
    /// The caller's cancel flag was set.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Error {
    /// A stable word for programs: `index_out_of_range`, `non_finite_coordinate`, `crossing_constraints`, `too_large`,
    /// `seed_on_constraint`, `split_unfinished`, `unsupported`, `out_of_memory`, `device_lost`, `bound_exceeded`, `internal`
    /// or `cancelled`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Input(MeshError::NonFiniteCoordinate { .. }) => "non_finite_coordinate",
            Self::Input(MeshError::IndexOutOfRange { .. }) => "index_out_of_range",
            Self::Input(MeshError::TooLarge { .. }) => "too_large",
            Self::CrossingConstraints { .. } => "crossing_constraints",
            Self::SeedOnConstraint { .. } => "seed_on_constraint",
            Self::SplitUnfinished { .. } => "split_unfinished",
            Self::SplitTooLarge { .. } => "too_large",
            Self::SeedNotFinite { .. } => "non_finite_coordinate",
            Self::Unsupported { .. } => "unsupported",
            Self::BoundExceeded { .. } => "bound_exceeded",
            Self::Input(_) | Self::Internal { .. } => "internal",
            Self::Cancelled(_) => "cancelled",
            Self::OutOfMemory { .. } => "out_of_memory",
            Self::DeviceLost { .. } => "device_lost",
        }
    }
}

/// Constraints through very many vertices: their chains, written out in full, cannot be numbered.
pub(crate) fn too_many_chain_vertices() -> Error {
    let (limit, what) = (Chains::MAX_VERTICES, "vertices along all constraints");
    MeshError::TooLarge { what, count: limit.saturating_add(1), limit }.into()
}

impl From<VoronoiError> for Error {
    fn from(error: VoronoiError) -> Self {
        match error {
            VoronoiError::GridSide { side, limit } => Self::Unsupported {
                what: format!("a grid of {side} pixels a side: between 1 and {limit} are possible"),
            },
            VoronoiError::NonFiniteCoordinate { point, axis } => MeshError::NonFiniteCoordinate { point, axis }.into(),
            VoronoiError::BoundExceeded { step, bound } => Self::BoundExceeded { stage: step, bound },
            other => Self::Internal { stage: "voronoi", what: other.to_string() },
        }
    }
}

impl From<DualizeError> for Error {
    fn from(error: DualizeError) -> Self {
        match error {
            DualizeError::Voronoi(error) => error.into(),
            DualizeError::Flip(error) => error.into(),
            DualizeError::Cancelled(cancelled) => cancelled.into(),
            DualizeError::BoundExceeded { stage, bound } => Self::BoundExceeded { stage, bound },
            DualizeError::WalkLost { steps, .. } => Self::BoundExceeded { stage: "insert", bound: steps },
            other => Self::Internal { stage: "dualize", what: other.to_string() },
        }
    }
}

impl From<polder_vulkan::Error> for Error {
    fn from(error: polder_vulkan::Error) -> Self {
        use polder_vulkan::Error as E;
        // Loaders explain themselves in several lines.
        let what = error.to_string().lines().next().unwrap_or_default().to_owned();
        match error {
            E::Cancelled => Cancelled.into(),
            E::Bound { name, bound } => Self::BoundExceeded { stage: name, bound: bound.into() },
            E::NoVulkan(_) | E::NoValidation | E::NoDevice { .. } | E::Unsupported { .. } => Self::Unsupported { what },
            E::TooLarge { .. } | E::OutOfMemory { .. } => Self::OutOfMemory { what },
            E::DeviceLost | E::Timeout { .. } => Self::DeviceLost { what },
            // Recordings are made here.
            _ => Self::Internal { stage: "vulkan", what },
        }
    }
}

impl From<CanonicalError> for Error {
    fn from(error: CanonicalError) -> Self {
        Self::Internal { stage: "canonical_order", what: error.to_string() }
    }
}

impl From<FlipError> for Error {
    fn from(error: FlipError) -> Self {
        match error {
            FlipError::Cancelled(cancelled) => cancelled.into(),
            FlipError::BoundExceeded { stage, rounds, .. } => Self::BoundExceeded { stage, bound: rounds },
            other => Self::Internal { stage: "flip", what: other.to_string() },
        }
    }
}

impl From<ConstrainError> for Error {
    fn from(error: ConstrainError) -> Self {
        match error {
            ConstrainError::CrossingConstraints(crossings) => {
                Self::CrossingConstraints { pairs: crossings.pairs, truncated: crossings.truncated }
            }
            ConstrainError::Flip(error) => error.into(),
            ConstrainError::TooLarge { .. } => too_many_chain_vertices(),
            ConstrainError::BoundExceeded { rounds, .. } => Self::BoundExceeded { stage: "constrain", bound: rounds },
            other => Self::Internal { stage: "constrain", what: other.to_string() },
        }
    }
}
