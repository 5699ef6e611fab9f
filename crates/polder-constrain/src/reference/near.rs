//! Vertices that a constraint passes at less than rounding can tell.

use super::exact::{Integer, parts};
use super::fan::{enter, leave};
use crate::{ConstrainError, Walk};
use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh};
use polder_predicates::Sign;

/// The vertices that constraint `i` passes at less than rounding can tell: some point of it, its ends left out, has their
/// coordinates when it is rounded to the nearest numbers. Vertices exactly on it are left out, and such rounded points as lie
/// halfway between numbers. Sorted.
///
/// Rounding keeps order, so along the constraint these vertices come, as rounded crossings do, in the order of their
/// coordinates. Only `wanted` vertices are looked at, and of these only corners of triangles that the constraint runs
/// through, or that it is an edge of.
///
/// # Errors
///
/// [`ConstrainError::Lost`] if the mesh is not the one that was walked.
pub fn near(
    mesh: &GhostMesh,
    positions: &[DVec2],
    walk: &Walk,
    i: usize,
    wanted: impl Fn(u32) -> bool,
) -> Result<Vec<u32>, ConstrainError> {
    let chain = walk.chains.get(i);
    let (Some(&a), Some(&b)) = (chain.first(), chain.last()) else { return Ok(Vec::new()) };
    let line = [a, b].map(|v| positions[v as usize]);
    let mut corners = Vec::new();
    for &s in walk.pieces(i) {
        let (ends, mut h) = (walk.sub_constraints[s as usize], walk.departures[s as usize]);
        if walk.crossed_edges[s as usize] == 0 {
            corners.extend([h, mesh.twin(h)].map(|h| mesh.apex(h)));
        }
        for _ in 0..walk.crossed_edges[s as usize] {
            corners.extend([mesh.origin(h), mesh.destination(h)]);
            let found = enter(mesh, positions, h, ends.map(|v| positions[v as usize]));
            let (g, side) = found.ok_or(ConstrainError::Lost { ends })?;
            h = leave(g, side);
        }
    }
    corners.retain(|&v| v != GHOST && wanted(v));
    corners.sort_unstable();
    corners.dedup();
    let is_near = |&v: &u32| positions.get(v as usize).is_some_and(|&p| passes(line, p));
    Ok(corners.into_iter().filter(is_near).filter(|v| !chain.contains(v)).collect())
}

/// Whether a point of the segment between its ends is `p` when its coordinates are rounded to the nearest numbers: one
/// inside the cell of `p`, not on its border.
fn passes([a, b]: [DVec2; 2], p: DVec2) -> bool {
    let (low, high) = (a.min(b), a.max(b));
    if p == a || p == b || p != p.clamp(low, high) {
        return false;
    }
    // Most are farther off than cells are large and this could err.
    let (d, q, size) = (b - a, p - a, low.abs().max(high.abs()));
    let error = 16.0 * f64::EPSILON * (d.x.abs() * size.y + d.y.abs() * size.x);
    if (d.x * q.y - d.y * q.x).abs() > error {
        return false;
    }
    // Twice each coordinate, since borders are halfway between numbers.
    let around = |x: f64| [x.next_down(), x, x.next_up()];
    let (xs, ys) = (around(p.x), around(p.y));
    let all = [a.x, a.y, b.x, b.y].into_iter().chain(xs).chain(ys);
    if !all.clone().all(f64::is_finite) {
        return false;
    }
    let unit = all.filter(|&x| x != 0.0).map(|x| parts(x).2).min().unwrap_or(0);
    let sum = |x: f64, y: f64| Integer::of(x, unit).minus(&Integer::of(-y, unit));
    let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(|x| sum(x, x));
    let (run, rise) = (bx.minus(&ax), by.minus(&ay));
    let side = |x: &Integer, y: &Integer| run.times(&y.minus(&ay)).minus(&rise.times(&x.minus(&ax))).sign();
    let [left, right] = [0, 2].map(|i| sum(xs[1], xs[i]));
    let [below, above] = [0, 2].map(|i| sum(ys[1], ys[i]));
    let sides = [side(&left, &below), side(&right, &below), side(&left, &above), side(&right, &above)];
    sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use dashu::rational::RBig;

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// By the definition: the stretch of the segment whose first coordinate rounds to that of `p` and the one whose second
    /// does have an inner point in common.
    fn by_definition([a, b]: [DVec2; 2], p: DVec2) -> bool {
        let (mut from, mut to) = (RBig::ZERO, RBig::ONE);
        for (a, b, x) in [(a.x, b.x, p.x), (a.y, b.y, p.y)] {
            let two = RBig::from(2);
            let [low, high] = [x.next_down(), x.next_up()].map(|other| (exact(x) + exact(other)) / &two);
            if a == b {
                if exact(a) <= low || exact(a) >= high {
                    return false;
                }
                continue;
            }
            let at = |border: RBig| (border - exact(a)) / (exact(b) - exact(a));
            let (s, t) = (at(low), at(high));
            from = from.max(s.clone().min(t.clone()));
            to = to.min(s.max(t));
        }
        p != a && p != b && from < to
    }

    #[test]
    fn cells_are_passed_as_defined() {
        let mut state = 0u32;
        let mut next = || {
            state = state.wrapping_add(0x9e37_79b9);
            polder_flip::priority(state)
        };
        let (mut passed, mut missed) = (0, 0);
        for round in 0..20_000 {
            let mut off = |x: f64, by: u32| f64::from_bits(x.to_bits() + u64::from(next() % by));
            let (x, y) = ([1.0, 0.9, 3.0, 1e-3, 1e-310][round % 5], [1.0, 0.3, 2.0f64.next_down(), 0.0][round % 4]);
            let wide = [4, 9, 40][round % 3];
            let mut point = || DVec2::new(off(x, wide), off(y, 7));
            let (a, b, p) = (point(), point(), point());
            let turned = |p: DVec2| match round % 7 {
                0 => DVec2::new(p.y, p.x),
                1 => DVec2::new(-p.x, p.y),
                _ => p,
            };
            let [a, b, p] = [a, b, p].map(turned);
            let expected = by_definition([a, b], p);
            assert_eq!(passes([a, b], p), expected, "{a} {b} {p}");
            assert_eq!(passes([b, a], p), expected);
            if expected { passed += 1 } else { missed += 1 }
        }
        assert!(passed > 1000 && missed > 2000, "{passed} {missed}");
    }

    #[test]
    fn the_largest_numbers_are_not_near_anything() {
        let m = f64::MAX;
        assert!(!passes([DVec2::new(-m, -m), DVec2::new(m, m)], DVec2::new(m, m.next_down())));
    }
}
