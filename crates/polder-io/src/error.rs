use std::fmt::{Display, Formatter, Result};
use thiserror::Error;

/// Where in a file something stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Place {
    /// A line of a text file, from 1.
    Line(u64),
    /// A byte of a binary file, from 0.
    Byte(u64),
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a file could not be read or written. `file` is its path, or `standard input`.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file is not what its format demands: truncated, garbled, or promising what it does not hold.
    #[error("{file}, {place}: {what}")]
    Malformed {
        /// The file.
        file: String,
        /// Where in it.
        place: Place,
        /// What is wrong there.
        what: String,
    },
    /// A segment or triangle names a point that does not exist.
    #[error(
        "{file}, {place}: {what} {} names point {index}, but {}",
        number + *first as u64,
        numbered(*first, *points)
    )]
    IndexOutOfRange {
        /// The file.
        file: String,
        /// Where in it.
        place: Place,
        /// `"segment"` or `"triangle"`.
        what: &'static str,
        /// Its index, from 0.
        number: u64,
        /// The point that it names, as written.
        index: i64,
        /// The number of the first point.
        first: u32,
        /// How many points there are.
        points: u64,
    },
    /// A coordinate is NaN or infinite, or too large for an f64.
    #[error("{file}, {place}: the {axis} coordinate of this point is not a finite number")]
    NonFiniteCoordinate {
        /// The file.
        file: String,
        /// Where in it.
        place: Place,
        /// The point's index, from 0.
        point: u64,
        /// `'x'` or `'y'`.
        axis: char,
    },
    /// More points, segments or triangles than can be numbered.
    #[error("{file}: more than {limit} {what}")]
    TooLarge {
        /// The file.
        file: String,
        /// `"points"`, `"segments"` or `"triangles"`.
        what: &'static str,
        /// The most that are possible.
        limit: u64,
    },
    /// The format, or this variant of it, cannot be read or written.
    #[error("{file}: {what}")]
    Unsupported {
        /// The file.
        file: String,
        /// What is not supported, and what to do instead.
        what: String,
    },
    /// The system could not open, read or write the file.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The cancel flag of the [`Source`](crate::Source) was set.
    #[error("cancelled while reading {file}")]
    Cancelled {
        /// The file.
        file: String,
    },
}

/// What the numbers of points are.
fn numbered(first: u32, points: u64) -> String {
    match points {
        0 => "there are no points".into(),
        1 => format!("the only point is {first}"),
        _ => format!("the points are numbered {first} to {}", first as u64 + points - 1),
    }
}

impl IoError {
    /// A stable word for programs: `malformed_file`, `index_out_of_range`, `non_finite_coordinate`, `too_large`,
    /// `unsupported`, `io` or `cancelled`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Malformed { .. } => "malformed_file",
            Self::IndexOutOfRange { .. } => "index_out_of_range",
            Self::NonFiniteCoordinate { .. } => "non_finite_coordinate",
            Self::TooLarge { .. } => "too_large",
            Self::Unsupported { .. } => "unsupported",
            Self::Io { .. } => "io",
            Self::Cancelled { .. } => "cancelled",
        }
    }

    /// Where in the file, if it is about a place in it.
    pub fn place(&self) -> Option<Place> {
        match self {
            Self::Malformed { place, .. }
            | Self::IndexOutOfRange { place, .. }
            | Self::NonFiniteCoordinate { place, .. } => Some(*place),
            _ => None,
        }
    }
}
