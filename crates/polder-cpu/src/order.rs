//! The points in an order in which every run of them is a compact patch of the plane.

use glam::DVec2;
use polder_predicates::lexicographic;
use std::cmp::Ordering;

/// Runs of equal keys up to this length are sorted lexicographically and split in the middle; longer ones are in kd-order.
const SHORT: usize = 3;
/// Bits of a key for each axis.
const BITS: u32 = 16;

/// A cut, by the axis that it crosses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    /// A vertical cut: by x, then by y.
    X,
    /// A horizontal cut: by y, then by falling x. This is the order of `X` turned by a right angle, so that "left"
    /// and "right" of a merge mean below and above.
    Y,
}

impl Axis {
    /// Whether `p` comes before `q` across the cut.
    #[inline]
    pub(crate) fn less(self, p: DVec2, q: DVec2) -> bool {
        match self {
            Self::X => p.x < q.x || (p.x == q.x && p.y < q.y),
            Self::Y => p.y < q.y || (p.y == q.y && p.x > q.x),
        }
    }

    fn compare(self, p: DVec2, q: DVec2) -> Ordering {
        match (self.less(p, q), self.less(q, p)) {
            (true, _) => Ordering::Less,
            (_, true) => Ordering::Greater,
            _ => Ordering::Equal,
        }
    }
}

/// The distinct points in Morton order.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    /// Positions.
    pub(crate) points: Vec<DVec2>,
    /// For each the input point: of equal ones the lowest.
    pub(crate) ids: Vec<u32>,
    /// Morton keys, rising.
    pub(crate) keys: Vec<u32>,
    /// For each input point the lowest point equal to it.
    pub(crate) representatives: Vec<u32>,
}

/// Where the run `lo..hi` of at least two points is cut, and across which axis.
pub(crate) fn split(points: &[DVec2], keys: &[u32], lo: usize, hi: usize) -> (usize, Axis) {
    let (first, last) = (keys[lo], keys[hi - 1]);
    if first == last {
        let axis = if hi - lo <= SHORT { Axis::X } else { long_axis(points[lo..hi].iter().copied()) };
        return (lo + (hi - lo) / 2, axis);
    }
    let bit = 31 - (first ^ last).leading_zeros();
    let edge = last >> bit << bit;
    let mid = lo + keys[lo..hi].partition_point(|&key| key < edge);
    (mid, if bit % 2 == 1 { Axis::Y } else { Axis::X })
}

/// The axis along which points extend farther.
fn long_axis(points: impl Iterator<Item = DVec2>) -> Axis {
    let (low, high) = bounds(points);
    // Halves, so that the extent of finite numbers is finite.
    let extent = high * 0.5 - low * 0.5;
    if extent.y > extent.x { Axis::Y } else { Axis::X }
}

fn bounds(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The bits of a number below 2^16, spread to the even places.
fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Sorts the points by Morton key, finds the duplicates, and puts long runs of equal keys into kd-order.
///
/// The keys are rounded, but monotone in each coordinate, and that is all that is needed of them: where rounding,
/// overflow or underflow throws points together, kd-order sets them apart.
pub(crate) fn order(input: &[DVec2]) -> Order {
    let (low, high) = bounds(input.iter().copied());
    let extent = (high * 0.5 - low * 0.5).max_element();
    let scale = f64::from((1u32 << BITS) - 1) / extent;
    let scale = if scale.is_finite() { scale } else { 0.0 };
    let key = |p: DVec2| {
        let q = (p * 0.5 - low * 0.5) * scale;
        spread(q.x as u32) | spread(q.y as u32) << 1
    };
    let mut sorted: Vec<u64> = input.iter().enumerate().map(|(i, &p)| u64::from(key(p)) << 32 | i as u64).collect();
    radix_sort(&mut sorted);

    let mut order = Order {
        points: Vec::with_capacity(input.len()),
        ids: Vec::with_capacity(input.len()),
        keys: Vec::with_capacity(input.len()),
        representatives: (0..input.len() as u32).collect(),
    };
    let mut run = Vec::new();
    let mut begin = 0;
    while begin < sorted.len() {
        let key = sorted[begin] >> 32;
        let length = 1 + sorted[begin + 1..].iter().take_while(|&&s| s >> 32 == key).count();
        if length == 1 {
            order.push(input[sorted[begin] as u32 as usize], sorted[begin] as u32, key as u32);
        } else {
            run.clear();
            run.extend(sorted[begin..begin + length].iter().map(|&s| (input[s as u32 as usize], s as u32)));
            order.push_run(&mut run, key as u32);
        }
        begin += length;
    }
    order
}

impl Order {
    fn push(&mut self, point: DVec2, id: u32, key: u32) {
        self.points.push(point);
        self.ids.push(id);
        self.keys.push(key);
    }

    /// Appends points of one key: sorts them, drops the duplicates, puts the rest into kd-order.
    fn push_run(&mut self, run: &mut Vec<(DVec2, u32)>, key: u32) {
        run.sort_unstable_by(|(p, i), (q, j)| lexicographic(*p, *q).then(i.cmp(j)));
        run.dedup_by(|(p, i), (q, j)| {
            let same = p == q;
            if same {
                self.representatives[*i as usize] = *j;
            }
            same
        });
        kd_order(run);
        for &mut (point, id) in run {
            self.push(point, id, key);
        }
    }
}

/// Sorts so that [`split`] may cut any run in the middle.
fn kd_order(run: &mut [(DVec2, u32)]) {
    if run.len() <= SHORT {
        run.sort_unstable_by(|(p, _), (q, _)| lexicographic(*p, *q));
        return;
    }
    let axis = long_axis(run.iter().map(|&(p, _)| p));
    let mid = run.len() / 2;
    run.select_nth_unstable_by(mid, |(p, _), (q, _)| axis.compare(*p, *q));
    let (left, right) = run.split_at_mut(mid);
    kd_order(left);
    kd_order(right);
}

/// Sorts by the upper 32 bits, equal ones in their order.
pub(crate) fn radix_sort(items: &mut Vec<u64>) {
    const DIGIT: u32 = 11;
    let mut other = vec![0; items.len()];
    for shift in [32, 32 + DIGIT, 32 + 2 * DIGIT] {
        let digit = |item: u64| (item >> shift) as usize & ((1 << DIGIT) - 1);
        let mut starts = [0u32; 1 << DIGIT];
        for &item in &*items {
            starts[digit(item)] += 1;
        }
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        for &item in &*items {
            let place = &mut starts[digit(item)];
            other[*place as usize] = item;
            *place += 1;
        }
        std::mem::swap(items, &mut other);
    }
}
