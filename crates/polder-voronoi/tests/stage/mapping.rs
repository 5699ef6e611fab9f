//! The grid mapping against rational arithmetic.

use crate::cases::Random;
use dashu::integer::IBig;
use dashu::rational::RBig;
use glam::DVec2;
use polder_voronoi::{GridMapping, MAX_SIDE, Options, Resolution};
use proptest::prelude::*;

fn exact(x: f64) -> RBig {
    RBig::try_from(x).unwrap()
}

fn two_to(exponent: i32) -> RBig {
    let power = RBig::from(IBig::from(1) << exponent.unsigned_abs() as usize);
    if exponent < 0 { RBig::ONE / power } else { power }
}

/// Families of coordinates, from the well-behaved to the outrageous.
const KINDS: usize = 14;

fn points(kind: usize, count: usize, seed: u64) -> Vec<DVec2> {
    let random = &mut Random(seed);
    let sign = |random: &mut Random| if random.below(2) == 0 { -1.0 } else { 1.0 };
    let mut coordinate = |axis: usize| match kind {
        0 => random.unit(),
        1 => random.unit() * 2000.0 - 1000.0,
        // Integers.
        2 => random.below(50) as f64 - 25.0,
        // One row or column of any numbers.
        3 => [random.unit(), 0.3][axis],
        4 => [-7.25e9, random.unit()][axis],
        // A few last places apart, far from zero.
        5 => 1e16 + 2.0 * random.below(30) as f64,
        6 => f64::from_bits(1.0_f64.to_bits() + random.below(300) as u64),
        7 => f64::from_bits((-0.1_f64).to_bits() + random.below(5) as u64),
        // The largest numbers there are, of both signs.
        8 => sign(random) * f64::MAX * [1.0, 0.75, random.unit(), 1.0 - 1e-15][random.below(4)],
        // The smallest: subnormal, and around the border of normal numbers.
        9 => sign(random) * f64::from_bits(random.below(1000) as u64),
        10 => sign(random) * f64::from_bits(f64::MIN_POSITIVE.to_bits() - 20 + random.below(40) as u64),
        // All magnitudes at once.
        11 => sign(random) * f64::from_bits(random.next() % f64::INFINITY.to_bits()),
        12 => [0.0, -0.0, 1e300, -1e-300, 5e-324, 1.0][random.below(6)],
        // Flat boxes.
        _ => [random.unit() * 1e6, 3.0 + random.unit() * 1e-6][axis],
    };
    (0..count).map(|_| DVec2::new(coordinate(0), coordinate(1))).collect()
}

/// The grid and the points' pixels, as one axis sees them.
struct Axis {
    low: f64,
    high: f64,
    pixels: u32,
    translation: i64,
    unit: RBig,
    side: RBig,
}

fn axes(mapping: &GridMapping, points: &[DVec2]) -> [Axis; 2] {
    [0, 1].map(|k| Axis {
        low: points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min),
        high: points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max),
        pixels: mapping.size()[k],
        translation: mapping.translation()[k],
        unit: two_to(mapping.exponents()[k]),
        side: two_to(mapping.exponents()[k]) * RBig::from(mapping.sides()[k]),
    })
}

/// Everything that a mapping promises.
fn assert_exact(points: &[DVec2], options: &Options) {
    let mapping = GridMapping::fit(points, options).unwrap();
    assert!(mapping.sides().iter().all(|&side| side > 0 && side.is_multiple_of(2) && side <= 1 << 20));
    let limit = match options.resolution {
        Resolution::LongerSide(side) => side,
        _ => MAX_SIDE,
    };
    for (k, axis) in axes(&mapping, points).iter().enumerate() {
        assert!((1..=limit).contains(&axis.pixels));
        let (side, start) = (&axis.side, &axis.unit * RBig::from(axis.translation));
        let in_grid = |pixel: u32| if k == 0 { [pixel, 0] } else { [0, pixel] };

        // Centers: exact, inside the box, and mapped back to their pixel.
        for pixel in [0, 1, axis.pixels / 2, axis.pixels - 1].into_iter().filter(|&p| p < axis.pixels) {
            let center = mapping.center(in_grid(pixel));
            assert!(center.is_finite());
            let half = RBig::from(2 * pixel + 1) / RBig::from(2);
            assert_eq!(exact(center[k]), &start + side * half);
            assert_eq!(mapping.pixel(center)[k], pixel);
            assert!(mapping.center_units(in_grid(pixel))[k].unsigned_abs() <= 1 << 53);
            if axis.pixels > 1 {
                assert!(axis.low <= center[k] && center[k] <= axis.high);
            }
        }

        // Points: the floor, or the last pixel for what lies at most half a pixel beyond.
        let mut positions: Vec<(f64, u32)> = Vec::new();
        for &point in points {
            let pixel = mapping.pixel(point)[k];
            if axis.pixels > 1 {
                let quotient = (exact(point[k]) - &start) / side;
                assert!(quotient >= RBig::ZERO);
                assert!(quotient < RBig::from(axis.pixels) + RBig::ONE / RBig::from(2));
                assert_eq!(IBig::from(pixel), quotient.floor().min(IBig::from(axis.pixels - 1)));
            } else {
                assert_eq!(pixel, 0);
            }
            positions.extend([(point[k], pixel), (mapping.center(mapping.pixel(point))[k], pixel)]);
        }
        // Different pixels mean strictly ordered positions, points and centers mixed.
        positions.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for pair in positions.windows(2) {
            assert!(pair[0].1 <= pair[1].1, "{pair:?}");
            assert!(pair[0].1 == pair[1].1 || pair[0].0 < pair[1].0, "{pair:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn mapping_is_exact(kind in 0..KINDS, count in 1_usize..20, side in 1..=MAX_SIDE, seed: u64) {
        let points = points(kind, count, seed);
        assert_exact(&points, &Resolution::LongerSide(side).into());
        assert_exact(&points, &Options::default());
    }

    #[test]
    fn mapping_is_exact_where_pixels_are_few(kind in 0..KINDS, count in 1_usize..9, side in 1_u32..9, seed: u64) {
        assert_exact(&points(kind, count, seed), &Resolution::LongerSide(side).into());
    }

    /// Axes of different kinds: a coordinate may be finer than the other axis lets a pixel be.
    #[test]
    fn mapping_is_exact_on_mixed_axes(kinds in [0..KINDS, 0..KINDS], count in 1_usize..20, seed: u64) {
        let (x, y) = (points(kinds[0], count, seed), points(kinds[1], count, seed ^ 1));
        let points: Vec<DVec2> = x.iter().zip(&y).map(|(x, y)| DVec2::new(x.x, y.y)).collect();
        assert_exact(&points, &Options::default());
        assert_exact(&points, &Resolution::LongerSide(100).into());
    }

    /// The grid is as large as asked for, unless the coordinates are too coarse or the box is thin.
    #[test]
    fn mapping_is_as_fine_as_asked(shape in 0.15..1.0_f64, count in 50_usize..2000, per_point in 1.0..20.0_f64, seed: u64) {
        let mut random = Random(seed);
        let mut points: Vec<DVec2> =
            (0..count).map(|_| DVec2::new(random.unit(), shape * random.unit()) * 1e-9).collect();
        points[..2].copy_from_slice(&[DVec2::ZERO, DVec2::new(1.0, shape) * 1e-9]);
        let mapping = GridMapping::fit(&points, &Resolution::PixelsPerPoint(per_point).into()).unwrap();
        let (area, wish) = (f64::from(mapping.width()) * f64::from(mapping.height()), count as f64 * per_point);
        // Rounding: a row or column either way, half a pixel in the mean.
        let slack = 1.0 + 2.0 / f64::from(mapping.height());
        prop_assert!(area < wish * slack && area > wish / slack - 2.0 * f64::from(mapping.width()), "{area} for {wish}");
    }
}

proptest! {
    /// Thin boxes, lying and standing, from any place: rows are not fewer than 32, and columns as many as the points ask for.
    #[test]
    fn mapping_of_thin_boxes_is_exact_and_has_rows(
        thin in 0..1000_i32, tall: bool, count in 40_usize..200, from in [-1e3..1e3, -1e3..1e3], seed: u64
    ) {
        let mut random = Random(seed);
        let [long, short] = from;
        let flat = 2.0_f64.powi(-6 - thin);
        let mut points: Vec<DVec2> =
            (0..count).map(|_| DVec2::new(long + random.unit(), short * flat + flat * random.unit())).collect();
        points[..2].copy_from_slice(&[DVec2::new(long, short * flat), DVec2::new(long + 1.0, (short + 1.0) * flat)]);
        if tall {
            points.iter_mut().for_each(|p| *p = DVec2::new(-p.y, p.x));
        }
        assert_exact(&points, &Options::default());
        assert_exact(&points, &Resolution::LongerSide(100).into());
        let mapping = GridMapping::fit(&points, &Options::default()).unwrap();
        let [width, height] = mapping.size();
        let (along, across) = if tall { (height, width) } else { (width, height) };
        let ideal = (7.0 * count as f64 / flat).sqrt().min(7.0 * count as f64);
        prop_assert!((f64::from(along) - ideal).abs() < 2.0, "{along} along, {ideal}");
        let most = (along / 8).min(32);
        prop_assert!(across <= most && across + 1 >= most, "{along} x {across}");
        prop_assert!(!mapping.is_square());
        prop_assert!(GridMapping::fit(&points, &Resolution::LongerSide(100).into()).unwrap().is_square());
    }
}

/// Where the grid cannot be as long as it would have to be, rows stay as low as they would be.
#[test]
fn a_side_cut_short_does_not_make_the_other_coarser() {
    let corners = [DVec2::ZERO, DVec2::new(1.0, 1e-3)];
    let bounds = polder_voronoi::Bounds::of(&corners).unwrap();
    // 7 million pixels: 83666 x 83 square ones.
    let mapping = GridMapping::fit_bounds(&bounds, None, 1_000_000, &Options::default()).unwrap();
    assert_eq!(mapping.size(), [MAX_SIDE, 83]);
    let square = GridMapping::fit_bounds(&bounds, None, 150_000, &Options::default()).unwrap();
    assert_eq!((square.size(), square.is_square()), ([32403, 32], true));
}

#[test]
fn one_point_or_equal_points_have_one_pixel() {
    for x in [0.0, -0.0, 1.0, -1e300, f64::MAX, f64::MIN, 5e-324, -5e-324, 0.1] {
        for y in [0.0, f64::MAX, f64::MIN, -5e-324] {
            let points = [DVec2::new(x, y); 3];
            assert_exact(&points, &Options::default());
            let mapping = GridMapping::fit(&points, &Options::default()).unwrap();
            assert_eq!(mapping.size(), [1, 1]);
            assert_eq!(mapping.pixel(points[0]), [0, 0]);
        }
    }
}

#[test]
fn points_in_a_row_have_a_strip_of_pixels() {
    let points: Vec<DVec2> = (0..100).map(|i| DVec2::new(f64::from(i), 5.0)).collect();
    let mapping = GridMapping::fit(&points, &Options::default()).unwrap();
    assert_eq!(mapping.size(), [700, 1]);
    let upright: Vec<DVec2> = points.iter().map(|p| DVec2::new(p.y, p.x)).collect();
    assert_eq!(GridMapping::fit(&upright, &Options::default()).unwrap().size(), [1, 700]);
}

/// The faults that a mapping by division has, each absent.
mod where_division_fails {
    use super::*;

    #[test]
    fn the_largest_coordinate_stays_on_the_grid() {
        let points = [DVec2::ZERO, DVec2::splat(1.0)];
        let mapping = GridMapping::fit(&points, &Resolution::LongerSide(8).into()).unwrap();
        assert_eq!((mapping.size(), mapping.pixel(points[1])), ([8, 8], [7, 7]));
    }

    #[test]
    fn negative_coordinates_do_not_fall_off_the_grid() {
        let points = [DVec2::splat(-3.7), DVec2::splat(-0.2)];
        let mapping = GridMapping::fit(&points, &Resolution::LongerSide(16).into()).unwrap();
        assert_eq!((mapping.pixel(points[0]), mapping.pixel(points[1])), ([0, 0], [15, 15]));
    }

    #[test]
    fn the_whole_range_of_f64_does_not_overflow() {
        let points = [DVec2::splat(f64::MIN), DVec2::ZERO, DVec2::splat(f64::MAX)];
        assert_exact(&points, &Resolution::LongerSide(MAX_SIDE).into());
        let mapping = GridMapping::fit(&points, &Resolution::LongerSide(4).into()).unwrap();
        assert_eq!(points.map(|p| mapping.pixel(p)), [[0, 0], [2, 2], [3, 3]]);
    }

    #[test]
    fn subnormal_ranges_have_a_scale() {
        let points = [DVec2::ZERO, DVec2::splat(5e-324 * 7.0)];
        let mapping = GridMapping::fit(&points, &Resolution::LongerSide(1000).into()).unwrap();
        assert_eq!((mapping.size(), mapping.sides()), ([4, 4], [2, 2]));
        assert_exact(&points, &Options::default());
    }

    /// Points at and right below the borders of pixels, where a rounded quotient is one too high.
    #[test]
    fn points_next_to_a_border_fall_on_the_right_side() {
        for &(low, high, side) in &[(0.0, 1.0, 10), (0.1, 0.7, 3), (-1.0 / 3.0, 1e3, 7)] {
            let corners = [DVec2::splat(low), DVec2::splat(high)];
            let mapping = GridMapping::fit(&corners, &Resolution::LongerSide(side).into()).unwrap();
            let unit = 2.0_f64.powi(mapping.exponents()[0]);
            for column in 1..mapping.width() {
                let units = mapping.translation()[0] + i64::from(mapping.sides()[0]) * i64::from(column);
                let border = DVec2::splat(units as f64 * unit);
                let below = DVec2::splat(border.x.next_down());
                assert_eq!([mapping.pixel(below)[0], mapping.pixel(border)[0]], [column - 1, column]);
            }
        }
    }
}

/// Why it takes integers: even with the same scale and translation, the floor of a rounded quotient is another pixel.
#[test]
fn rounding_division_finds_other_pixels() {
    let corners = [DVec2::splat(-0.9), DVec2::splat(0.1)];
    let mapping = GridMapping::fit(&corners, &Resolution::LongerSide(1000).into()).unwrap();
    let unit = 2.0_f64.powi(mapping.exponents()[0]);
    let (scale, translation) = (f64::from(mapping.sides()[0]) * unit, mapping.translation()[0] as f64 * unit);
    let differs = |column: &u32| {
        let border = translation + f64::from(*column) * scale;
        let below = border.next_down();
        let rounded = ((below - translation) / scale).floor() as u32;
        rounded != mapping.pixel(DVec2::splat(below))[0]
    };
    assert!((1..1000).filter(differs).count() > 0);
}

#[test]
fn points_outside_the_grid_go_to_the_nearest_pixel() {
    let mapping = GridMapping::fit(&[DVec2::ZERO, DVec2::ONE], &Resolution::LongerSide(10).into()).unwrap();
    assert_eq!(mapping.pixel(DVec2::new(f64::MAX, f64::MIN)), [9, 0]);
    assert_eq!(mapping.pixel(DVec2::new(f64::NEG_INFINITY, f64::INFINITY)), [0, 9]);
}

/// The grids of many points, adaptive and not.
mod crowds {
    use super::*;
    use polder_voronoi::reference::map;

    fn grids(points: &[DVec2]) -> [(u64, usize); 2] {
        [Resolution::Adaptive, Resolution::PixelsPerPoint(7.0)].map(|resolution| {
            let mapping = GridMapping::fit(points, &resolution.into()).unwrap();
            assert!(mapping.is_square());
            let [width, height] = mapping.size().map(u64::from);
            (width * height, map(points, &mapping).unwrap().count)
        })
    }

    #[test]
    fn what_fills_its_box_has_seven_pixels_a_point() {
        for count in [65_536, 100_000, 300_000] {
            let mut random = Random(count as u64);
            let uniform: Vec<DVec2> = (0..count).map(|_| DVec2::new(random.unit(), random.unit())).collect();
            let lattice: Vec<DVec2> = (0..count).map(|i| DVec2::new((i % 256) as f64, (i / 256) as f64)).collect();
            for points in [uniform, lattice] {
                let [adaptive, plain] = grids(&points);
                assert_eq!(adaptive, plain);
            }
        }
    }

    /// Points on a circle, and in a few heaps.
    #[test]
    fn what_crowds_has_two() {
        let count = 200_000;
        let mut random = Random(5);
        let mut circle = |_| {
            let angle = std::f64::consts::TAU * random.unit();
            DVec2::new(angle.cos(), 0.7 * angle.sin())
        };
        let circle: Vec<DVec2> = (0..count).map(&mut circle).collect();
        let mut random = Random(6);
        let mut heap = |i| DVec2::new(random.unit(), random.unit()) * 1e-5 + DVec2::new((i % 3) as f64, (i % 7) as f64);
        let heaps: Vec<DVec2> = (0..count).map(&mut heap).collect();
        for points in [circle, heaps] {
            let [(pixels, sites), plain] = grids(&points);
            assert!(plain.0 > 1_390_000 && plain.0 / plain.1 as u64 > 32, "{plain:?}");
            assert!((390_000..410_000).contains(&pixels) && sites > 20, "{pixels} pixels, {sites} sites");
        }
    }

    /// Thin boxes have few cells along one side, from which nothing is to be learned.
    #[test]
    fn thin_boxes_are_what_they_were() {
        let mut random = Random(7);
        let points: Vec<DVec2> = (0..100_000).map(|_| DVec2::new(random.unit(), 1e-3 * random.unit())).collect();
        let thin = |resolution: Resolution| GridMapping::fit(&points, &resolution.into()).unwrap();
        assert_eq!(thin(Resolution::Adaptive), thin(Resolution::PixelsPerPoint(7.0)));
    }
}
