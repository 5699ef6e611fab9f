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
//! Pixels are square, unless the box is thin: see below. Then steps 1 and 3 are made for each axis by itself, and each has
//! a unit and a half side of its own.
//!
//! Why the centers are exact: an axis with two pixels or more has its first center at or above the lowest coordinate
//! (`T` is less than one unit below it, `h` is at least one) and its last at or below the highest (step 4). An axis of
//! one pixel is placed around the middle of its coordinates, rounded toward zero. So no center is larger than the
//! largest coordinate along its axis, each is a multiple of the unit, and the unit is at least that coordinate's last
//! place.
//!
//! Why order is kept: a point strictly left of the last column lies in `[T + 2hp, T + 2h(p + 1))`, in units, as does
//! the center of its pixel; the last column takes what lies beyond as well. So if two positions, each of them a point
//! or the center of its pixel, belong to different columns, they are strictly ordered as their columns are. This is all
//! that later stages ask of the mapping, it speaks of one axis at a time, and so it holds for pixels of any shape.
//!
//! # Thin boxes
//!
//! Square pixels leave a thin box few rows: one, say, for two rows of points that are closer than the columns. Then
//! all sites are points of one row, the other row goes into a fan of triangles as long as the box, and flips bring that
//! to order in quadratic time (60,000 points: 422 million flips). So the shorter side gets at least [`FEW`] pixels, but
//! not more than an eighth of the longer one's; and where [`MAX_SIDE`] cuts the longer side short, the shorter one keeps
//! its pixels as narrow as they would have been. What is colored is then the diagram of the points as the grid sees them,
//! stretched; its dual is a triangulation of the true points as well, and flips make it Delaunay. They are about one for
//! each point where points lie at random in a box thinner than they are apart, and up to five beyond a million points;
//! with more rows their number grows, for neighbors in the grid are then farther and farther from being neighbors. Twice
//! as few rows were cheaper for such points by a sixth, and slower by far for lattices of more rows than that.
//!
//! The caller who asks for a number of pixels along the longer side gets square ones in any case.
//!
//! # Crowds
//!
//! Unless told otherwise there are 7 pixels for each point, but fewer where the points leave most of their box empty: see the
//! module `occupancy`.
//!
//! Departures: \[QCT\] divides by a rounded scale, which may put a point into a neighboring pixel; its translation
//! truncates instead of flooring, its largest coordinate falls off the grid, and its range overflows or vanishes for
//! the largest and smallest numbers. Its sites stand at the lower left corners of pixels; here at their centers.

use crate::bounds::checked_count;
use crate::occupancy::USUAL;
use crate::{Bounds, Occupancy, VoronoiError};
use glam::DVec2;

/// The longest side of a grid, in pixels.
pub const MAX_SIDE: u32 = 1 << 15;

/// A pixel's half side has at most this many bits.
const HALF_BITS: u32 = 19;

/// The shorter side of a grid has at least so many pixels,
const FEW: u128 = 32;
/// if that is at most this part of the longer one.
const THIN: u128 = 8;

/// How fine the grid shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Resolution {
    /// 7 pixels for each point; fewer where points crowd, so that most of them would have no site anywhere near.
    Adaptive,
    /// About so many pixels for each point, as far as the longest side allows; more where the bounding box is so thin that
    /// few rows, or columns, would be left.
    PixelsPerPoint(f64),
    /// At most so many pixels along the longer side of the bounding box, fewer where the coordinates are not that fine; all
    /// square.
    LongerSide(u32),
}

/// Choices of the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// How fine the grid shall be; adaptive unless told.
    pub resolution: Resolution,
}

impl Default for Options {
    fn default() -> Self {
        Self { resolution: Resolution::Adaptive }
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
    /// The unit is 2 to this power.
    exponent: i32,
    /// Half the side of a pixel, in units; at least 1.
    half: i64,
    /// Where the grid starts, in units.
    translation: i64,
    /// How many pixels it has.
    pixels: u32,
}

/// A grid of pixels, all of one size, over the bounding box of a point set. See the module's source for the arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridMapping {
    axes: [Axis; 2],
}

impl GridMapping {
    /// Fits a grid to the bounding box of the points.
    ///
    /// # Errors
    ///
    /// If there are no points, a coordinate is not finite, or the resolution is out of its range.
    pub fn fit(points: &[DVec2], options: &Options) -> Result<Self, VoronoiError> {
        let bounds = Bounds::of(points)?;
        let is_adaptive = options.resolution == Resolution::Adaptive;
        let occupancy = if is_adaptive { Occupancy::of(points, &bounds) } else { None };
        Self::fit_bounds(&bounds, occupancy.as_ref(), points.len(), options)
    }

    /// Fits a grid to a bounding box of so many points: with their occupancy the same grid as the points themselves give.
    /// Where none is given they are taken to fill the box.
    ///
    /// # Errors
    ///
    /// If the number is zero or more than 32-bit numbers can count, or the resolution is out of its range.
    pub fn fit_bounds(
        bounds: &Bounds,
        occupancy: Option<&Occupancy>,
        points: usize,
        options: &Options,
    ) -> Result<Self, VoronoiError> {
        checked_count(points)?;
        let ranges = Range::of(bounds);
        let finest = ranges[0].finest().max(ranges[1].finest());
        let extent = ranges.map(|range| range.extent(finest));
        let axes = match Wish::of(points, occupancy, extent, options.resolution)? {
            Wish::Square { longer } => {
                let scale = Scale::of(extent[0].max(extent[1]), longer, finest);
                ranges.map(|range| Axis::fit(range, scale))
            }
            Wish::Stretched { pixels } => [0, 1].map(|k| {
                let (range, finest) = (ranges[k], ranges[k].finest());
                Axis::fit(range, Scale::of(range.extent(finest), pixels[k], finest))
            }),
        };
        Ok(Self { axes })
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

    /// The units, in which everything along an axis is an integer, are 2 to these powers.
    pub fn exponents(&self) -> [i32; 2] {
        self.axes.map(|axis| axis.exponent)
    }

    /// The width and the height of a pixel, in units: even, and at most 20 bits.
    pub fn sides(&self) -> [u32; 2] {
        self.axes.map(|axis| 2 * axis.half as u32)
    }

    /// The lower left corner of the grid, in units.
    pub fn translation(&self) -> [i64; 2] {
        self.axes.map(|axis| axis.translation)
    }

    /// Whether pixels are as wide as high.
    pub fn is_square(&self) -> bool {
        let [x, y] = self.axes;
        (x.exponent, x.half) == (y.exponent, y.half)
    }

    /// The pixel that a point lies in; for a point outside the grid, the nearest one along each axis.
    ///
    /// The point's coordinates must not be NaN.
    pub fn pixel(&self, point: DVec2) -> [u32; 2] {
        [self.axes[0].pixel(point.x), self.axes[1].pixel(point.y)]
    }

    /// The center of a pixel, in units: at most `2^53` in magnitude for a pixel of the grid.
    pub fn center_units(&self, pixel: [u32; 2]) -> [i64; 2] {
        [0, 1].map(|k| self.axes[k].translation + (2 * i64::from(pixel[k]) + 1) * self.axes[k].half)
    }

    /// The center of a pixel of the grid, exactly.
    pub fn center(&self, pixel: [u32; 2]) -> DVec2 {
        // Both factors are exact and so is the product: it is a multiple of the unit no longer than the longest
        // coordinate, whose last place is at most the unit.
        let [x, y] = self.center_units(pixel);
        let [unit_x, unit_y] = self.exponents().map(power_of_two);
        DVec2::new(x as f64 * unit_x, y as f64 * unit_y)
    }
}

/// The least and the largest coordinate along an axis.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(bounds: &Bounds) -> [Self; 2] {
        let (low, high) = (bounds.low(), bounds.high());
        [Self { low: low.x, high: high.x }, Self { low: low.y, high: high.y }]
    }

    /// The last place of the largest coordinate.
    fn finest(self) -> i32 {
        last_place(self.low.abs().max(self.high.abs()))
    }

    /// Strictly more than it measures, in units; zero if it has no extent at all.
    fn extent(self, exponent: i32) -> u64 {
        let units = floor_units(self.high, exponent) - floor_units(self.low, exponent) + 1;
        if self.low == self.high { 0 } else { units as u64 }
    }
}

/// A unit, and the half side of a pixel in units.
#[derive(Clone, Copy, Debug)]
struct Scale {
    exponent: i32,
    half: i64,
}

impl Scale {
    /// That by which so many units, 2 to the power `finest`, are at most so many pixels.
    fn of(extent: u64, pixels: u32, finest: i32) -> Self {
        let mut doublings = 0;
        let half_at = |doublings: u32| u128::from(extent).div_ceil(u128::from(2 * pixels) << doublings);
        while half_at(doublings) > 1 << HALF_BITS {
            doublings += 1;
        }
        Self { exponent: finest + doublings as i32, half: (half_at(doublings) as i64).max(1) }
    }
}

impl Axis {
    fn fit(Range { low, high }: Range, Scale { exponent, half }: Scale) -> Self {
        let (first, last) = (floor_units(low, exponent), floor_units(high, exponent));
        // The nearest whole number of pixels: floor((last - first) / 2h + 1/2).
        let pixels = (last - first + half) / (2 * half);
        if pixels > 0 {
            return Self { exponent, half, translation: first, pixels: pixels as u32 };
        }
        let toward_zero = |x: f64| if x < 0.0 { -floor_units(-x, exponent) } else { floor_units(x, exponent) };
        let center = (toward_zero(low) + toward_zero(high)) / 2;
        Self { exponent, half, translation: center - half, pixels: 1 }
    }

    fn pixel(self, x: f64) -> u32 {
        // No overflow: at most 2^62, and 2^54.
        let from_start = floor_units(x, self.exponent) - self.translation;
        from_start.div_euclid(2 * self.half).clamp(0, i64::from(self.pixels) - 1) as u32
    }
}

/// How many pixels there shall be.
#[derive(Clone, Copy, Debug)]
enum Wish {
    /// Square ones, so many along the longer side.
    Square { longer: u32 },
    /// So many along each axis.
    Stretched { pixels: [u32; 2] },
}

impl Wish {
    /// What the caller says, or such that the area has the pixels wanted.
    fn of(
        points: usize,
        occupancy: Option<&Occupancy>,
        extent: [u64; 2],
        resolution: Resolution,
    ) -> Result<Self, VoronoiError> {
        let per_point = match resolution {
            Resolution::LongerSide(side) if (1..=MAX_SIDE).contains(&side) => return Ok(Self::Square { longer: side }),
            Resolution::LongerSide(side) => return Err(VoronoiError::GridSide { side, limit: MAX_SIDE }),
            Resolution::Adaptive => f64::from(USUAL),
            Resolution::PixelsPerPoint(wanted) if (1.0 / 1024.0..=1024.0).contains(&wanted) => wanted,
            Resolution::PixelsPerPoint(_) => return Err(VoronoiError::PixelsPerPoint),
        };
        // The wish in 1/1024; at most 2^20 times 2^32 points, times 2^54 units: far from the end of 128 bits.
        let area = (points as u128 * (per_point * 1024.0) as u128 / 1024).max(1);
        let area = occupancy.filter(|_| resolution == Resolution::Adaptive).map_or(area, |o| o.pixels(points as u128));
        let (longer, shorter) = (u128::from(extent[0].max(extent[1])), u128::from(extent[0].min(extent[1])));
        // A side w along the longer extent makes w * w * shorter / longer pixels, and at least w.
        let side = (area * longer).checked_div(shorter).map_or(area, |square| square.isqrt().min(area)).max(1);
        let (along, across) = (side.min(u128::from(MAX_SIDE)), area / side);
        let least = (along / THIN).min(FEW);
        if shorter == 0 || (side == along && across >= least) {
            return Ok(Self::Square { longer: along as u32 });
        }
        let across = across.clamp(least, along);
        let pixels = if extent[0] >= extent[1] { [along, across] } else { [across, along] };
        Ok(Self::Stretched { pixels: pixels.map(|side| side as u32) })
    }
}

/// The exponent of the last place of a finite number: the number is an integer of at most 53 bits times 2 to it.
pub(crate) fn last_place(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52 & 0x7ff) as i32;
    biased.max(1) - 1075
}

/// `floor(x / 2^exponent)`, saturated at 62 bits.
pub(crate) fn floor_units(x: f64, exponent: i32) -> i64 {
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
