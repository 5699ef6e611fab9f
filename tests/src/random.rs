//! Inputs of any kind, from a number alone: what no family thought of.

use glam::DVec2;
use polder::Pslg;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

struct Random(Pcg64Mcg);

impl Random {
    fn below(&mut self, bound: u32) -> u32 {
        self.0.next_u32() % bound.max(1)
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2f64.powi(-53)
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u32) as usize]
    }

    /// Between 3 and `most`, small numbers as often as large ones.
    fn size(&mut self, most: usize) -> usize {
        (3.0 * (most as f64 / 3.0).powf(self.unit())) as usize
    }

    fn in_unit_square(&mut self) -> DVec2 {
        DVec2::new(self.unit(), self.unit())
    }

    /// Points of one kind, around the unit square.
    fn cloud(&mut self, len: usize) -> Vec<DVec2> {
        let kind = self.below(9);
        let side = self.pick(&[2, 5, 16, 100, 1000]);
        let slope = self.unit();
        let centers: Vec<DVec2> = (0..1 + self.below(9)).map(|_| self.in_unit_square()).collect();
        let scale = 2f64.powi(-(self.below(40) as i32));
        let point = |random: &mut Random| match kind {
            0 | 1 => random.in_unit_square(),
            // Integers: duplicates, points on lines and on circles.
            2 | 3 => DVec2::new(f64::from(random.below(side)), f64::from(random.below(side))),
            // Crowds.
            4 => random.pick(&centers) + scale * (random.in_unit_square() - DVec2::splat(0.5)),
            // On a line up to rounding, and a few beside it.
            5 => {
                let x = random.unit();
                let off = if random.below(50) == 0 { scale * random.unit() } else { 0.0 };
                DVec2::new(x, slope * x + off)
            }
            // On circles.
            6 => random.pick(&centers) + 0.3 * DVec2::from_angle(std::f64::consts::TAU * random.unit()),
            // Points of which each is much smaller than the one before.
            7 => {
                let exponent = random.below(60) as i32;
                (random.in_unit_square() - DVec2::splat(0.5)) * 2f64.powi(-exponent)
            }
            // Rows.
            _ => DVec2::new(random.unit(), f64::from(random.below(4)) * scale),
        };
        (0..len).map(|_| point(self)).collect()
    }

    /// Edges of some length: among neighbors in a Morton-like order, or among any two points.
    fn constraints(&mut self, points: &[DVec2]) -> Vec<[u32; 2]> {
        let len = points.len() as u32;
        let mut near: Vec<u32> = (0..len).collect();
        let across = 1 + self.below(30);
        let row = |v: &u32| {
            let p = points[*v as usize];
            ((p.y * f64::from(across)).floor(), p.x, p.y)
        };
        near.sort_by(|a, b| row(a).partial_cmp(&row(b)).unwrap_or(std::cmp::Ordering::Equal));
        let all = match self.below(4) {
            0 => 0,
            1 => self.below(12),
            2 => self.below(len / 4 + 2),
            _ => self.below(len + len / 2),
        };
        let hub = self.below(len);
        let (long, stars) = (self.below(4) == 0, self.below(6) == 0);
        (0..all)
            .map(|i| match (stars && i % 2 == 0, long && i % 64 == 0) {
                (true, _) => [hub, self.below(len)],
                (_, true) => [self.below(len), self.below(len)],
                _ => {
                    let a = self.below(len);
                    let step = 1 + self.below(3);
                    [near[a as usize], near[((a + step) % len) as usize]]
                }
            })
            .collect()
    }
}

/// Up to `most` points and one and a half times as many constraints, which may cross.
///
/// # Panics
///
/// Never: all points are finite, and all ends are points.
pub fn random(seed: u64, most: usize) -> Pslg {
    let mut random = Random(Pcg64Mcg::seed_from_u64(seed));
    let len = random.size(most);
    let mut points = random.cloud(len);
    if random.below(3) == 0 {
        let (more, shift) = (random.size(most), random.in_unit_square());
        let scale = 2f64.powi(random.below(60) as i32 - 30);
        points.extend(random.cloud(more).into_iter().map(|point| (point + shift) * scale));
    }
    if random.below(8) == 0 {
        let scale = random.pick(&[1e-300, 1e-150, 1e150, 1e290]);
        points.iter_mut().for_each(|point| *point *= scale);
    }
    let constraints = random.constraints(&points);
    Pslg::new(points, constraints).unwrap_or_else(|error| panic!("{error}"))
}
