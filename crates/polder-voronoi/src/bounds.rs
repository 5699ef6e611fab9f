//! The bounding box of points.

use crate::VoronoiError;
use glam::DVec2;

/// The bounding box of points that are all finite; negative zeros count as zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    low: DVec2,
    high: DVec2,
}

/// The most points that 32-bit numbers count.
const LIMIT: usize = (u32::MAX - 1) as usize;

impl Bounds {
    /// Those of the points.
    ///
    /// # Errors
    ///
    /// If there are no points, more than 32-bit numbers can count, or a coordinate is not finite.
    pub fn of(points: &[DVec2]) -> Result<Self, VoronoiError> {
        let Some(&first) = points.first() else { return Err(VoronoiError::NoPoints) };
        checked_count(points.len())?;
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            let axis = if points[point].x.is_finite() { 'y' } else { 'x' };
            return Err(VoronoiError::NonFiniteCoordinate { point, axis });
        }
        let [low, high] = points.iter().fold([first; 2], |[low, high], &p| [low.min(p), high.max(p)]);
        // Adding zero makes a zero of a negative one.
        Ok(Self { low: low + DVec2::ZERO, high: high + DVec2::ZERO })
    }

    /// From five numbers, as [`reference::bound_points`](crate::reference::bound_points) gives them.
    ///
    /// # Errors
    ///
    /// If they are those of no points, or a coordinate is not finite.
    pub fn of_words([low_x, high_x, low_y, high_y, unfit]: [u64; 5]) -> Result<Self, VoronoiError> {
        if unfit != u64::MAX {
            let axis = if unfit & 1 == 0 { 'x' } else { 'y' };
            return Err(VoronoiError::NonFiniteCoordinate { point: (unfit >> 1) as usize, axis });
        }
        let low = DVec2::new(number(low_x), number(low_y));
        let high = DVec2::new(number(high_x), number(high_y));
        // Of nothing, they are the wrong way round.
        if low_x > high_x || low_y > high_y || !low.is_finite() || !high.is_finite() {
            return Err(VoronoiError::NoPoints);
        }
        Ok(Self { low, high })
    }

    /// The least coordinates.
    pub fn low(&self) -> DVec2 {
        self.low
    }

    /// The largest coordinates.
    pub fn high(&self) -> DVec2 {
        self.high
    }
}

/// [`VoronoiError`] for numbers of points that no grid can have.
pub(crate) fn checked_count(points: usize) -> Result<(), VoronoiError> {
    match points {
        0 => Err(VoronoiError::NoPoints),
        _ if points > LIMIT => Err(VoronoiError::TooManyPoints { points, limit: LIMIT }),
        _ => Ok(()),
    }
}

/// The number that an integer stands for, which is ordered like it.
fn number(ordered: u64) -> f64 {
    f64::from_bits(if ordered >> 63 == 1 { ordered & !(1 << 63) } else { !ordered })
}
