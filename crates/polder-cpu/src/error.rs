use polder_mesh::{Cancelled, Chains};
use thiserror::Error;

/// Why the CPU backend gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CpuError {
    /// A constraint crosses an earlier one. Which pairs cross is found by enumerating them on the unconstrained mesh.
    #[error("constraint {constraint} crosses another one")]
    Crossing {
        /// The constraint that was being inserted.
        constraint: u32,
    },
    /// A constraint names a point that does not exist.
    #[error("constraint {constraint}: there is no point {index}")]
    IndexOutOfRange {
        /// The constraint at fault.
        constraint: u32,
        /// The index that it names.
        index: u32,
    },
    /// The chains of the constraints, written out in full, have more vertices than can be numbered.
    #[error(
        "constraint {constraint}: up to it the chains of vertices along constraints are longer than {} in all",
        Chains::MAX_VERTICES
    )]
    TooLarge {
        /// The constraint at which the limit was passed.
        constraint: u32,
    },
    /// A walk or a row of flips ran past its bound: a defect, caught before it could hang.
    #[error("constraint {constraint}: the {what} ran past its bound")]
    BoundExceeded {
        /// The constraint that was being inserted.
        constraint: u32,
        /// What ran too long.
        what: &'static str,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
