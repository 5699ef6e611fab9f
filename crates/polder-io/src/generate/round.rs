//! Points on circles, nearly or exactly.

use super::pslg;
use super::random::Random;
use glam::DVec2;
use polder_mesh::Pslg;

/// Points on the unit circle, as near as rounding allows.
pub fn circle(n: usize, seed: u64) -> Pslg {
    let mut random = Random::new("circle", seed);
    pslg((0..n).map(|_| random.direction()).collect(), Vec::new())
}

/// Points on `circles` circles about the origin, of radius 1, 2, 3, ...; each point chooses its circle at random.
pub fn concentric(n: usize, circles: usize, seed: u64) -> Pslg {
    let mut random = Random::new("concentric", seed);
    let point = |_| (1 + random.below(circles.max(1) as u64)) as f64 * random.direction();
    pslg((0..n).map(point).collect(), Vec::new())
}

/// Points between the circles of radius 1 and 1 + `width`. A `width` that is not finite counts as 0.
pub fn thin_ring(n: usize, width: f64, seed: u64) -> Pslg {
    let mut random = Random::new("thin-ring", seed);
    let width = if width.is_finite() { width.clamp(-1e300, 1e300) } else { 0.0 };
    pslg((0..n).map(|_| (1.0 + width * random.unit()) * random.direction()).collect(), Vec::new())
}

/// Distinct integer points *exactly* on one circle of radius 48,612,265 about the origin, in random order.
///
/// There are 2,916 of them; further points lie on the circles of twice, three times, ... that radius.
pub fn cocircular(n: usize, seed: u64) -> Pslg {
    // The radius is the product of these primes a² + b², each the norm of the Gaussian integer a + bi. Multiplying one
    // of (a + bi)², a² + b², (a - bi)² for each prime, and a unit, gives every integer point of that circle.
    const PRIMES: [(i64, i64); 6] = [(2, 1), (3, 2), (4, 1), (5, 2), (6, 1), (5, 4)];
    let times = |(a, b): (i64, i64), (c, d): (i64, i64)| (a * c - b * d, a * d + b * c);
    let mut circle = vec![(1, 0), (0, 1), (-1, 0), (0, -1)];
    for (a, b) in PRIMES {
        let factors = [times((a, b), (a, b)), (a * a + b * b, 0), times((a, -b), (a, -b))];
        circle = circle.iter().flat_map(|&p| factors.map(|f| times(p, f))).collect();
    }
    let mut random = Random::new("cocircular", seed);
    let mut points = Vec::with_capacity(n);
    for multiple in 1.. {
        random.shuffle(&mut circle);
        let scale = multiple as f64;
        points.extend(circle.iter().take(n - points.len()).map(|&(x, y)| scale * DVec2::new(x as f64, y as f64)));
        if points.len() == n {
            break;
        }
    }
    pslg(points, Vec::new())
}
