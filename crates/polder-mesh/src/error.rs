use thiserror::Error;

/// What can be wrong with an input or a mesh, with the index at fault.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("point {point}: its {axis} coordinate is not a finite number")]
    NonFiniteCoordinate {
        /// Index of the first such point.
        point: usize,
        /// `'x'` or `'y'`.
        axis: char,
    },
    /// A constraint names a point that does not exist.
    #[error("constraint {constraint}: it names point {index}, but there are only {points} points")]
    IndexOutOfRange {
        /// Index of the first such constraint.
        constraint: usize,
        /// The index that it names.
        index: u32,
        /// How many points there are.
        points: usize,
    },
    /// More points or constraints than 32-bit ids can number.
    #[error("{count} {what}: at most {limit} are possible")]
    TooLarge {
        /// `"points"` or `"constraints"`.
        what: &'static str,
        /// How many were given.
        count: usize,
        /// The most that are possible.
        limit: usize,
    },
    /// The links of a mesh contradict each other.
    #[error("triangle {triangle}: {what}")]
    Broken {
        /// Index of the first triangle found at fault.
        triangle: usize,
        /// What is wrong with it.
        what: &'static str,
    },
}
