//! Bounds of points, as integers that are ordered like the coordinates.

use glam::DVec2;

/// What the bounds of nothing are.
const NOTHING: [u64; 5] = [u64::MAX, 0, u64::MAX, 0, u64::MAX];

/// Ordered like the numbers; both zeros are one. Numbers that are not finite lie beyond all others.
fn ordered(x: f64) -> u64 {
    let bits = if x == 0.0 { 0 } else { x.to_bits() };
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

fn joined(a: [u64; 5], b: [u64; 5]) -> [u64; 5] {
    [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3]), a[4].min(b[4])]
}

/// Least and largest x, least and largest y as ordered integers, and of the first coordinate that is not finite twice the
/// point's index, plus one if it is the y: for each of `groups` workgroups, which take the points in turns of `workgroup`.
pub fn bound_points(points: &[DVec2], groups: usize, workgroup: usize) -> Vec<[u64; 5]> {
    let mut partial = vec![NOTHING; groups];
    for (index, point) in points.iter().enumerate() {
        let (x, y) = (ordered(point.x), ordered(point.y));
        let unfit = match (point.x.is_finite(), point.y.is_finite()) {
            (true, true) => u64::MAX,
            (good_x, _) => (index as u64) << 1 | u64::from(good_x),
        };
        let partial = &mut partial[index / workgroup % groups];
        *partial = joined(*partial, [x, x, y, y, unfit]);
    }
    partial
}

/// All joined.
pub fn bound_partials(partial: &[[u64; 5]]) -> [u64; 5] {
    partial.iter().fold(NOTHING, |a, b| joined(a, *b))
}
