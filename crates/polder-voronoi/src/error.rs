use thiserror::Error;

/// What can go wrong in this stage.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum VoronoiError {
    /// There are no points, so there is no bounding box and no grid.
    #[error("no points: a grid needs at least one")]
    NoPoints,
    /// More points than 32-bit numbers can count.
    #[error("{points} points: at most {limit} are possible")]
    TooManyPoints {
        /// How many were given.
        points: usize,
        /// The most that are possible.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {point}: its {axis} coordinate is not a finite number")]
    NonFiniteCoordinate {
        /// Index of the first such point.
        point: usize,
        /// `'x'` or `'y'`.
        axis: char,
    },
    /// The longer side asked for is zero or more than the grid can have.
    #[error("a grid with a longer side of {side} pixels: between 1 and {limit} are possible")]
    GridSide {
        /// The side asked for.
        side: u32,
        /// The longest side possible.
        limit: u32,
    },
    /// The number of pixels for each point is not a number between 1/1024 and 1024.
    #[error("the number of pixels for each point must lie between 1/1024 and 1024")]
    PixelsPerPoint,
    /// The parts handed to a step do not belong together.
    #[error("{what}, at index {index}")]
    Mismatch {
        /// What does not fit.
        what: &'static str,
        /// The pixel or site at fault.
        index: usize,
    },
    /// A loop ran past the bound that its input gives it. This is a bug in this crate.
    #[error("{step}: more than {bound} rounds")]
    BoundExceeded {
        /// The step whose loop it was.
        step: &'static str,
        /// The bound.
        bound: u64,
    },
}
