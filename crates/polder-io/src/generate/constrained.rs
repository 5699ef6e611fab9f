//! Points with constraints that do not cross, by construction.

use super::random::Random;
use super::{points, pslg};
use glam::DVec2;
use polder_mesh::Pslg;

/// `n` points along a spiral, each joined to the next: half a unit apart, the coils one unit apart.
pub fn spiral(n: usize) -> Pslg {
    let (mut radius, mut d) = (1.0f64, DVec2::X);
    let point = |_| {
        let p = radius * d;
        // The turn by the angle whose half has the tangent t, renormalized so that it does not drift.
        let t = 0.25 / radius;
        let turned = DVec2::new((1.0 - t * t) * d.x - 2.0 * t * d.y, 2.0 * t * d.x + (1.0 - t * t) * d.y);
        d = turned / (turned.x * turned.x + turned.y * turned.y).sqrt();
        radius += 2.0 * t / std::f64::consts::TAU;
        p
    };
    pslg((0..n).map(point).collect(), (1..n as u32).map(|i| [i - 1, i]).collect())
}

/// `n` points, alternately at the foot and the tip of teeth 1000 high and 1 wide, each joined to the next.
pub fn comb(n: usize) -> Pslg {
    let point = |i: usize| DVec2::new(i as f64 / 2.0, if i.is_multiple_of(2) { 0.0 } else { 1000.0 });
    pslg((0..n).map(point).collect(), (1..n as u32).map(|i| [i - 1, i]).collect())
}

/// One point with `k` constraints to `k` others above it, some three times as far as others, and `k` points more
/// strewn among them.
pub fn fan(k: usize, seed: u64) -> Pslg {
    let mut random = Random::new("fan", seed);
    let height = k as f64;
    let rim = (0..k).map(|i| (1 + i % 3) as f64 * DVec2::new(i as f64 - (k / 2) as f64, height)).collect::<Vec<_>>();
    let free = (0..k).map(|_| 3.0 * height * (random.square() - DVec2::new(0.5, 0.0))).collect::<Vec<_>>();
    let points = [vec![DVec2::ZERO], rim, free].concat();
    pslg(points, (1..=k as u32).map(|i| [0, i]).collect())
}

/// One constraint through `k` further points exactly on it, with `k` points strewn around.
pub fn through_vertices(k: usize, seed: u64) -> Pslg {
    let mut random = Random::new("through-vertices", seed);
    let line = points::collinear(k + 2, seed).into_parts().0;
    let side = 7.0 * (k + 2) as f64;
    let free: Vec<_> = (0..k).map(|_| side * random.square()).collect();
    let by_y = |&i: &u32| line[i as usize].y as u64;
    let all = 0..k as u32 + 2;
    let ends = [all.clone().min_by_key(by_y).unwrap_or(0), all.max_by_key(by_y).unwrap_or(0)];
    pslg([line, free].concat(), vec![ends])
}

/// Closed square outlines, one inside the other, `rings` of them, their sides cut at every `step`-th integer: what a
/// contour map of a pyramid looks like, full of ties. Corners are always points.
pub fn nested_rings(rings: usize, step: usize) -> Pslg {
    let (mut points, mut constraints) = (Vec::new(), Vec::new());
    for ring in 1..=rings {
        let r = ring as f64;
        let corners = [DVec2::new(-r, -r), DVec2::new(r, -r), DVec2::new(r, r), DVec2::new(-r, r)];
        let first = points.len() as u32;
        for (i, &corner) in corners.iter().enumerate() {
            let along = (corners[(i + 1) % 4] - corner) / (2.0 * r);
            points.extend((0..2 * ring).step_by(step.max(1)).map(|k| corner + k as f64 * along));
        }
        let count = points.len() as u32 - first;
        constraints.extend((0..count).map(|i| [first + i, first + (i + 1) % count]));
    }
    pslg(points, constraints)
}
