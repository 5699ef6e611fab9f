//! Vertices that are no input points.

use crate::ConstraintId;
use glam::DVec2;

/// A vertex that was added where constraints cross.
///
/// Added vertices are numbered behind the input's points: by the round in which they were found, then by x, then by y.
#[derive(Clone, Debug, PartialEq)]
pub struct AddedVertex {
    /// Where it is.
    pub position: DVec2,
    /// The round, from 1 on: crossings of edges that were themselves cut before come in later ones.
    pub round: u32,
    /// The constraints that run through it, ascending.
    pub parents: Vec<ConstraintId>,
}

impl Eq for AddedVertex {}
