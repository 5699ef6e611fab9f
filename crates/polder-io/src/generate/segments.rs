//! The synthetic inputs of [QCT] 5.1: constraints of widely varying length that do not touch each other, then points
//! on none of them.
//!
//! [QCT] do not say how theirs were made. Here:
//!
//! 1. Everything lies on integers below 2³⁰ in x and y, so that an orientation test is exact in 64 bits; at the end
//!    all is scaled into the unit square by 2⁻³⁰.
//! 2. The i-th longest of the constraints is to be 1 / (2 √i) long, times a factor from 1/2 to 2. Then at any moment
//!    about the same part of all placements is free, and 10M points with 1M constraints give what [QCT] report: about
//!    six crossed triangles a constraint, and the longest some thousands.
//! 3. From long to short, each takes a random place and direction inside the square; if it touches an earlier one, it
//!    tries again, and gets shorter by a quarter with every 16th failure.
//! 4. A grid of about as many cells as constraints lists the ones that meet each cell, so that a try costs a few tests.
//! 5. The remaining points are random, those on a constraint drawn again.

use super::pslg;
use super::random::{Random, power_of_two};
use glam::DVec2;
use polder_mesh::{Constraint, Pslg};

const BITS: u32 = 30;
const SIDE: i64 = 1 << BITS;
const NONE: u32 = u32::MAX;
/// Four units: enough that the two ends differ after rounding.
const SHORTEST: f64 = 4.0 / SIDE as f64;

type Point = [i64; 2];
type Segment = [Point; 2];

/// `points` points and `constraints` constraints among them: no two constraints touch, and the points that are no
/// constraint's end lie on none. The ends come first, constraint i from point 2i to point 2i + 1.
///
/// At least `2 * constraints` points are made. Beyond some ten million constraints the square may be too full for
/// another one to be found in a thousand tries; then there are fewer, and more free points.
pub fn segments(points: usize, constraints: usize, seed: u64) -> Pslg {
    let points = points.max(constraints.saturating_mul(2));
    let mut random = Random::new("segments", seed);
    let mut lengths: Vec<f64> =
        (1..=constraints).map(|i| (0.5 + 1.5 * random.unit()) * 0.5 / (i as f64).sqrt()).collect();
    lengths.sort_unstable_by(|a, b| b.total_cmp(a));
    let mut index = Index::new(constraints);
    for length in lengths {
        place(&mut random, &mut index, length.min(1.0));
    }
    let segments = &index.segments;
    let mut coordinates: Vec<Point> = Vec::with_capacity(points);
    coordinates.extend(segments.iter().flatten());
    // A point of the grid is free with a chance far above one half: the constraints cover few of 2⁶⁰.
    while coordinates.len() < points {
        let p = grid_point(&mut random);
        if !index.covers(p) {
            coordinates.push(p);
        }
    }
    finish(&coordinates, segments.len())
}

/// `constraints` constraints between points of their own, of length up to `length`, that cross, touch or miss each
/// other as it happens, and `points` in all, at least two a constraint.
pub fn crossing_segments(points: usize, constraints: usize, length: f64, seed: u64) -> Pslg {
    let mut random = Random::new("crossing-segments", seed);
    let points = points.max(constraints.saturating_mul(2));
    let length = if length.is_finite() { length.clamp(0.0, 1.0) } else { 1.0 };
    let mut coordinates = Vec::with_capacity(points);
    while coordinates.len() < 2 * constraints {
        let long = (length * random.unit()).max(SHORTEST);
        coordinates.extend(candidate(&mut random, long).into_iter().flatten());
    }
    coordinates.extend((coordinates.len()..points).map(|_| grid_point(&mut random)));
    finish(&coordinates, constraints)
}

fn finish(coordinates: &[Point], constraints: usize) -> Pslg {
    let scale = power_of_two(-(BITS as i32));
    let points = coordinates.iter().map(|&[x, y]| scale * DVec2::new(x as f64, y as f64)).collect();
    pslg(points, (0..constraints as u32).map(|i| [2 * i, 2 * i + 1] as Constraint).collect())
}

fn grid_point(random: &mut Random) -> Point {
    let bits = random.bits();
    [(bits >> (64 - BITS)) as i64, (bits & (SIDE as u64 - 1)) as i64]
}

/// A segment of about this length at a random place, if it lies in the square and is not a point.
fn candidate(random: &mut Random, length: f64) -> Option<Segment> {
    let [x, y] = grid_point(random);
    let d = random.direction() * (0.5 * length * SIDE as f64);
    let (dx, dy) = (d.x as i64, d.y as i64);
    let segment = [[x - dx, y - dy], [x + dx, y + dy]];
    let inside = segment.iter().flatten().all(|c| (0..SIDE).contains(c));
    (inside && segment[0] != segment[1]).then_some(segment)
}

fn place(random: &mut Random, index: &mut Index, mut length: f64) {
    for round in 0..1024 {
        if let Some(segment) = candidate(random, length)
            && !index.touches(&segment)
        {
            index.insert(segment);
            return;
        }
        if round % 16 == 15 {
            length = (0.75 * length).max(SHORTEST);
        }
    }
}

/// Twice the area of `abc`: below 2⁶², exactly.
fn orientation(a: Point, b: Point, c: Point) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn contains([a, b]: &Segment, p: Point) -> bool {
    let within = |k: usize| (a[k].min(b[k])..=a[k].max(b[k])).contains(&p[k]);
    within(0) && within(1) && orientation(*a, *b, p) == 0
}

fn touch(s: &Segment, t: &Segment) -> bool {
    let sides = |s: &Segment, t: &Segment| {
        let [p, q] = t.map(|p| orientation(s[0], s[1], p).signum());
        p * q
    };
    let (of_t, of_s) = (sides(s, t), sides(t, s));
    if of_t < 0 && of_s < 0 {
        return true;
    }
    if of_t > 0 || of_s > 0 {
        return false;
    }
    t.iter().any(|&p| contains(s, p)) || s.iter().any(|&p| contains(t, p))
}

/// The constraints so far, listed by the cells of a square grid that they meet.
struct Index {
    segments: Vec<Segment>,
    shift: u32,
    width: usize,
    heads: Vec<u32>,
    /// A segment and the next entry of the same cell.
    entries: Vec<[u32; 2]>,
}

impl Index {
    fn new(constraints: usize) -> Self {
        let level = (constraints.max(1).ilog2() / 2).min(13);
        let width = 1usize << level;
        Self {
            segments: Vec::with_capacity(constraints),
            shift: BITS - level,
            width,
            heads: vec![NONE; width * width],
            entries: Vec::with_capacity(3 * constraints),
        }
    }

    /// The cells that a segment may meet, column by column; a superset by at most the neighbors of its ends.
    fn cells(&self, &[p, q]: &Segment) -> impl Iterator<Item = usize> + use<> {
        let (a, b) = if p[0] <= q[0] { (p, q) } else { (q, p) };
        let (shift, width) = (self.shift, self.width);
        (a[0] >> shift..=b[0] >> shift).flat_map(move |column| {
            let y = |x: i64| {
                let x = x.clamp(a[0], b[0]);
                // One more unit on both sides makes up for the rounding.
                if a[0] == b[0] { a[1] } else { a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) }
            };
            let (mut from, mut to) = (y(column << shift), y((column + 1) << shift));
            if a[0] == b[0] {
                (from, to) = (a[1], b[1]);
            }
            let low = (from.min(to) - 1).max(0) >> shift;
            let high = (from.max(to) + 1).min(SIDE - 1) >> shift;
            (low..=high).map(move |row| row as usize * width + column as usize)
        })
    }

    fn listed(&self, cell: usize) -> impl Iterator<Item = &Segment> {
        let mut entry = self.heads[cell];
        std::iter::from_fn(move || {
            let &[segment, next] = self.entries.get(entry as usize)?;
            entry = next;
            Some(&self.segments[segment as usize])
        })
    }

    fn touches(&self, segment: &Segment) -> bool {
        self.cells(segment).any(|cell| self.listed(cell).any(|other| touch(segment, other)))
    }

    fn covers(&self, p: Point) -> bool {
        let cell = (p[1] >> self.shift) as usize * self.width + (p[0] >> self.shift) as usize;
        self.listed(cell).any(|segment| contains(segment, p))
    }

    fn insert(&mut self, segment: Segment) {
        for cell in self.cells(&segment) {
            self.entries.push([self.segments.len() as u32, self.heads[cell]]);
            self.heads[cell] = self.entries.len() as u32 - 1;
        }
        self.segments.push(segment);
    }
}
