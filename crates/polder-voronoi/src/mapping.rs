//! The mapping between the plane and the grid, exact both ways.
//!
//! Source: \[QCT\] Appendix B, which this departs from (see below). Along each axis, with a *unit* `2^e` and a pixel
//! side of `2h` units,
//!
//! ```text
//! pixel(x)  = floor((floor(x / 2^e) - T) / 2h), clamped into the grid
//! center(p) = (T + (2p + 1) h) 2^e
//! ```
//!
//! where `h`, `T` and `p` are integers. A floor of a floor is the floor of the whole, so no rounding happens anywhere.
//! The steps of [`GridMapping::fit`]:
//!
//! 1. Take the bounding box, and as the first unit the last place of the largest coordinate. All coordinates are then
//!    at most `2^53` units long, and their floors are integers of 54 bits whatever their magnitude.
//! 2. Choose the number of pixels along the longer side from the number of points and the shape of the box.
//! 3. Double the unit until the half side `h` of a pixel has at most 19 bits (the side 20), rounding `h` up, so that
//!    the longer side never exceeds what step 2 chose.
//! 4. Floor the translation to a unit, and round the number of pixels along each axis to the nearest whole one.
//!
//! Why the centers are exact: an axis with two pixels or more has its first center at or above the lowest coordinate
//! (`T` is less than one unit below it, `h` is at least one) and its last at or below the highest (step 4). An axis of
//! one pixel is placed around the middle of its coordinates, rounded toward zero. So no center is larger than the
//! largest coordinate, each is a multiple of the unit, and the unit is at least that coordinate's last place.
//!
//! Why order is kept: a point strictly left of the last column lies in `[T + 2hp, T + 2h(p + 1))`, in units, as does
//! the center of its pixel; the last column takes what lies beyond as well. So if two positions, each of them a point
//! or the center of its pixel, belong to different columns, they are strictly ordered as their columns are.
//!
//! Departures: \[QCT\] divides by a rounded scale, which may put a point into a neighboring pixel; its translation
//! truncates instead of flooring, its largest coordinate falls off the grid, and its range overflows or vanishes for
//! the largest and smallest numbers. Its sites stand at the lower left corners of pixels; here at their centers.

use crate::bounds::checked_count;
use crate::{Bounds, VoronoiError};
use glam::DVec2;

/// The longest side of a grid, in pixels.
pub const MAX_SIDE: u32 = 1 << 15;

/// A pixel's half side has at most this many bits.
const HALF_BITS: u32 = 19;

/// How fine the grid shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Resolution {
    /// About so many pixels for each point, as far as the longest side allows.
    PixelsPerPoint(f64),
    /// At most so many pixels along the longer side of the bounding box; fewer where the coordinates are not that fine.
    LongerSide(u32),
}

/// Choices of the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// How fine the grid shall be; 7 pixels for each point unless told.
    pub resolution: Resolution,
}

impl Default for Options {
    fn default() -> Self {
        Self { resolution: Resolution::PixelsPerPoint(7.0) }
    }
}

impl From<Resolution> for Options {
    fn from(resolution: Resolution) -> Self {
        Self { resolution }
    }
}

/// One axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Axis {
    /// Where the grid starts, in units.
    translation: i64,
    /// How many pixels it has.
    pixels: u32,
}

/// A grid of square pixels over the bounding box of a point set. See the module's source for the arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridMapping {
    /// The unit is 2 to this power.
    exponent: i32,
    /// Half the side of a pixel, in units; at least 1.
    half: i64,
    axes: [Axis; 2],
}

impl GridMapping {
    /// Fits a grid to the bounding box of the points.
    ///
    /// # Errors
    ///
    /// If there are no points, a coordinate is not finite, or the resolution is out of its range.
    pub fn fit(points: &[DVec2], options: &Options) -> Result<Self, VoronoiError> {
        Self::fit_bounds(&Bounds::of(points)?, points.len(), options)
    }

    /// Fits a grid to a bounding box of so many points: the same grid as the points themselves give.
    ///
    /// # Errors
    ///
    /// If the number is zero or more than 32-bit numbers can count, or the resolution is out of its range.
    pub fn fit_bounds(bounds: &Bounds, points: usize, options: &Options) -> Result<Self, VoronoiError> {
        checked_count(points)?;
        let (low, high) = (bounds.low(), bounds.high());
        let largest = [low, high].into_iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let finest = last_place(largest);
        let floors = |p: DVec2| p.to_array().map(|x| floor_units(x, finest));
        let (low_units, high_units) = (floors(low), floors(high));
        // Strictly more than the box measures, in units; zero where it has no extent at all.
        let extent = [0, 1].map(|k| {
            let extent = high_units[k] - low_units[k] + 1;
            if low[k] == high[k] { 0 } else { extent as u64 }
        });
        let longer = extent[0].max(extent[1]);
        let side = longer_side(points, extent, options.resolution)?;

        let mut doublings = 0;
        let half_at = |doublings: u32| u128::from(longer).div_ceil(u128::from(2 * side) << doublings);
        while half_at(doublings) > 1 << HALF_BITS {
            doublings += 1;
        }
        let half = (half_at(doublings) as i64).max(1);
        let exponent = finest + doublings as i32;
        let axes = [0, 1].map(|k| Axis::fit(low[k], high[k], exponent, half));
        Ok(Self { exponent, half, axes })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.axes[0].pixels
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.axes[1].pixels
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.axes.map(|axis| axis.pixels)
    }

    /// The unit, in which everything is an integer, is 2 to this power.
    pub fn exponent(&self) -> i32 {
        self.exponent
    }

    /// The side of a pixel, in units: even, and at most 20 bits.
    pub fn side(&self) -> u32 {
        2 * self.half as u32
    }

    /// The lower left corner of the grid, in units.
    pub fn translation(&self) -> [i64; 2] {
        self.axes.map(|axis| axis.translation)
    }

    /// The pixel that a point lies in; for a point outside the grid, the nearest one along each axis.
    ///
    /// The point's coordinates must not be NaN.
    pub fn pixel(&self, point: DVec2) -> [u32; 2] {
        let of = |axis: Axis, x: f64| {
            // No overflow: at most 2^62, and 2^54.
            let from_start = floor_units(x, self.exponent) - axis.translation;
            from_start.div_euclid(2 * self.half).clamp(0, i64::from(axis.pixels) - 1) as u32
        };
        [of(self.axes[0], point.x), of(self.axes[1], point.y)]
    }

    /// The center of a pixel, in units: at most `2^53` in magnitude for a pixel of the grid.
    pub fn center_units(&self, pixel: [u32; 2]) -> [i64; 2] {
        [0, 1].map(|k| self.axes[k].translation + (2 * i64::from(pixel[k]) + 1) * self.half)
    }

    /// The center of a pixel of the grid, exactly.
    pub fn center(&self, pixel: [u32; 2]) -> DVec2 {
        let unit = power_of_two(self.exponent);
        // Both factors are exact and so is the product: it is a multiple of the unit no longer than the longest
        // coordinate, whose last place is at most the unit.
        DVec2::from_array(self.center_units(pixel).map(|units| units as f64 * unit))
    }
}

impl Axis {
    fn fit(low: f64, high: f64, exponent: i32, half: i64) -> Self {
        let (first, last) = (floor_units(low, exponent), floor_units(high, exponent));
        // The nearest whole number of pixels: floor((last - first) / 2h + 1/2).
        let pixels = (last - first + half) / (2 * half);
        if pixels > 0 {
            return Self { translation: first, pixels: pixels as u32 };
        }
        let toward_zero = |x: f64| if x < 0.0 { -floor_units(-x, exponent) } else { floor_units(x, exponent) };
        let center = (toward_zero(low) + toward_zero(high)) / 2;
        Self { translation: center - half, pixels: 1 }
    }
}

/// Pixels along the longer side: what the caller says, or such that the area has the pixels wanted.
fn longer_side(points: usize, extent: [u64; 2], resolution: Resolution) -> Result<u32, VoronoiError> {
    let per_point = match resolution {
        Resolution::LongerSide(side) if (1..=MAX_SIDE).contains(&side) => return Ok(side),
        Resolution::LongerSide(side) => return Err(VoronoiError::GridSide { side, limit: MAX_SIDE }),
        Resolution::PixelsPerPoint(wanted) if (1.0 / 1024.0..=1024.0).contains(&wanted) => wanted,
        Resolution::PixelsPerPoint(_) => return Err(VoronoiError::PixelsPerPoint),
    };
    // The wish in 1/1024; at most 2^20 times 2^32 points, times 2^54 units: far from the end of 128 bits.
    let area = (points as u128 * (per_point * 1024.0) as u128 / 1024).max(1);
    let (longer, shorter) = (u128::from(extent[0].max(extent[1])), u128::from(extent[0].min(extent[1])));
    // A side w along the longer extent makes w * w * shorter / longer pixels, and at least w.
    let side = (area * longer).checked_div(shorter).map_or(area, |square| square.isqrt().min(area));
    Ok(side.clamp(1, u128::from(MAX_SIDE)) as u32)
}

/// The exponent of the last place of a finite number: the number is an integer of at most 53 bits times 2 to it.
fn last_place(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52 & 0x7ff) as i32;
    biased.max(1) - 1075
}

/// `floor(x / 2^exponent)`, saturated at 62 bits.
fn floor_units(x: f64, exponent: i32) -> i64 {
    let fraction = (x.to_bits() & ((1 << 52) - 1)) as i64;
    let implicit = if x.to_bits() >> 52 & 0x7ff == 0 { 0 } else { 1 << 52 };
    let magnitude = fraction | implicit;
    let significand = if x.is_sign_negative() { -magnitude } else { magnitude };
    let shift = last_place(x) - exponent;
    match shift {
        ..0 => significand >> (-shift).min(63),
        0..=9 => significand << shift,
        10.. => significand.signum() << 62,
    }
}

/// 2 to a power between -1074 and 1023.
fn power_of_two(exponent: i32) -> f64 {
    if exponent >= -1022 {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    } else {
        f64::from_bits(1 << (exponent + 1074))
    }
}
