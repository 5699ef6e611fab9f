use crate::{ConstraintId, MeshError};
use glam::DVec2;

/// A constraint: the indices of its two points. Both may be the same, and constraints may repeat or overlap.
pub type Constraint = [u32; 2];

/// A planar straight-line graph: the whole input.
///
/// Every coordinate is finite and every index in range; nothing else is demanded. Points may repeat,
/// constraints may have zero length, repeat, overlap or cross: what becomes of them is decided, and
/// reported, downstream.
///
/// ```
/// use polder_mesh::{DVec2, MeshError, Pslg};
///
/// let points = vec![DVec2::new(0.0, 0.0), DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)];
/// let pslg = Pslg::new(points.clone(), vec![[0, 1]])?;
/// assert_eq!(pslg.points().len(), 3);
///
/// let error = Pslg::new(points, vec![[0, 1], [2, 9]]).unwrap_err();
/// assert_eq!(error, MeshError::IndexOutOfRange { constraint: 1, index: 9, points: 3 });
/// # Ok::<(), MeshError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pslg {
    points: Vec<DVec2>,
    constraints: Vec<Constraint>,
}

impl Pslg {
    /// The most points a PSLG can have: a triangulation of them has fewer than 2³² half-edges, ghosts included.
    pub const MAX_POINTS: usize = (u32::MAX / 6) as usize - 2;
    /// The most constraints a PSLG can have.
    pub const MAX_CONSTRAINTS: usize = u32::MAX as usize / 2;

    /// Takes points and constraints as they are, after checking them.
    ///
    /// # Errors
    ///
    /// [`MeshError::NonFiniteCoordinate`] and [`MeshError::IndexOutOfRange`] name the first point or
    /// constraint at fault; [`MeshError::TooLarge`] says how many are possible.
    pub fn new(points: Vec<DVec2>, constraints: Vec<Constraint>) -> Result<Self, MeshError> {
        let sizes =
            [("points", points.len(), Self::MAX_POINTS), ("constraints", constraints.len(), Self::MAX_CONSTRAINTS)];
        for (what, count, limit) in sizes {
            if count > limit {
                return Err(MeshError::TooLarge { what, count, limit });
            }
        }
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            let axis = if points[point].x.is_finite() { 'y' } else { 'x' };
            return Err(MeshError::NonFiniteCoordinate { point, axis });
        }
        for (constraint, ends) in constraints.iter().enumerate() {
            if let Some(&index) = ends.iter().find(|&&end| end as usize >= points.len()) {
                return Err(MeshError::IndexOutOfRange { constraint, index, points: points.len() });
            }
        }
        Ok(Self { points, constraints })
    }

    /// The points, in input order.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The constraints, in input order.
    pub fn constraints(&self) -> &[Constraint] {
        &self.constraints
    }

    /// The constraints whose two ends are equal in value, whether or not they are the same point.
    pub fn zero_length_constraints(&self) -> impl Iterator<Item = ConstraintId> + '_ {
        self.constraints
            .iter()
            .enumerate()
            .filter(|(_, [a, b])| self.points[*a as usize] == self.points[*b as usize])
            .map(|(i, _)| ConstraintId(i as u32))
    }

    /// Gives the points and constraints back.
    pub fn into_parts(self) -> (Vec<DVec2>, Vec<Constraint>) {
        (self.points, self.constraints)
    }
}
