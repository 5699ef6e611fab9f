//! The canonical tie-break: one end for all flips from all starts, the one that the perturbed lifting defines.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, permutations, pythagorean};
use dashu::integer::IBig;
use glam::{DVec2, dvec2};
use polder_predicates::{Sign, incircle, incircle_canonical, lexicographic, must_flip, orient2d};
use std::cmp::Ordering;
use std::collections::{BTreeSet, HashSet};

/// Whether the edge `bc` between the triangles `abc` and `dcb` must be flipped.
type Rule = fn(DVec2, DVec2, DVec2, DVec2) -> bool;

/// Triangles counterclockwise from their smallest vertex, sorted.
type Mesh = BTreeSet<[usize; 3]>;

fn triangle(a: usize, b: usize, c: usize) -> [usize; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Distinct points with small coordinates, full of ties, not all on one line.
fn point_set(random: &mut Random, n: usize) -> Vec<DVec2> {
    let side = random.pick(&[2, 3, 3, 4, 7]).max((n as f64).sqrt().ceil() as i64 - 1);
    loop {
        let mut points: Vec<DVec2> = Vec::new();
        while points.len() < n {
            let p = dvec2(random.integer(0, side) as f64, random.integer(0, side) as f64);
            if !points.contains(&p) {
                points.push(p);
            }
        }
        if points.iter().any(|&p| orient2d(points[0], points[1], p) != Sign::Zero) {
            return points;
        }
    }
}

/// Whether two segments meet other than at a common end.
fn cross(points: &[DVec2], e: [usize; 2], f: [usize; 2]) -> bool {
    let side = |e: [usize; 2], v: usize| orient2d(points[e[0]], points[e[1]], points[v]);
    let apart = |e: [usize; 2], f: [usize; 2]| {
        let (s, t) = (side(e, f[0]), side(e, f[1]));
        s == t || s == Sign::Zero || t == Sign::Zero
    };
    !(apart(e, f) || apart(f, e))
}

/// All edges that pass through no third point.
fn candidate_edges(points: &[DVec2]) -> Vec<[usize; 2]> {
    let n = points.len();
    let blocked = |i: usize, j: usize| {
        (0..n).any(|k| {
            let (p, q, v) = (points[i], points[j], points[k]);
            k != i && k != j && orient2d(p, q, v) == Sign::Zero && (p - v).dot(q - v) < 0.0
        })
    };
    (0..n).flat_map(|i| (0..i).map(move |j| [i, j])).filter(|&[i, j]| !blocked(i, j)).collect()
}

/// A triangulation from edges taken in random order, the first `constraints` of which are constrained.
fn random_start(random: &mut Random, points: &[DVec2], fixed: &[[usize; 2]]) -> Mesh {
    let mut candidates = candidate_edges(points);
    random.shuffle(&mut candidates);
    let mut edges: Vec<[usize; 2]> = fixed.to_vec();
    for e in candidates {
        if !edges.contains(&e) && edges.iter().all(|&f| !cross(points, e, f)) {
            edges.push(e);
        }
    }
    let has = |i: usize, j: usize| edges.contains(&[i.max(j), i.min(j)]);
    let n = points.len();
    let mut mesh = Mesh::new();
    for (i, j, k) in (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..n).map(move |k| (i, j, k)))) {
        let (a, b, c) = (points[i], points[j], points[k]);
        let smallest_first = i < j && i < k;
        if smallest_first && has(i, j) && has(j, k) && has(k, i) && orient2d(a, b, c) == Sign::Positive {
            let inside = |v: usize| {
                let p = points[v];
                let sides = [orient2d(a, b, p), orient2d(b, c, p), orient2d(c, a, p)];
                ![i, j, k].contains(&v) && sides.iter().all(|s| *s != Sign::Negative)
            };
            if !(0..n).any(inside) {
                mesh.insert([i, j, k]);
            }
        }
    }
    mesh
}

/// All flips that the rule demands: `[a, b, c, d]` for the edge `bc` between `abc` and `dcb`.
fn demanded(points: &[DVec2], mesh: &Mesh, fixed: &[[usize; 2]], rule: Rule) -> Vec<[usize; 4]> {
    let mut flips = Vec::new();
    for t in mesh {
        for k in 0..3 {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            if b < c || fixed.contains(&[b.max(c), b.min(c)]) {
                continue;
            }
            let opposite = (0..points.len()).find(|&d| mesh.contains(&triangle(d, c, b)));
            if let Some(d) = opposite
                && rule(points[a], points[b], points[c], points[d])
            {
                flips.push([a, b, c, d]);
            }
        }
    }
    flips
}

fn flipped(mesh: &Mesh, [a, b, c, d]: [usize; 4]) -> Mesh {
    let mut mesh = mesh.clone();
    assert!(mesh.remove(&triangle(a, b, c)) && mesh.remove(&triangle(d, c, b)));
    assert!(mesh.insert(triangle(a, b, d)) && mesh.insert(triangle(a, d, c)));
    mesh
}

fn strictly_convex(points: &[DVec2], [a, b, c, d]: [usize; 4]) -> bool {
    let ccw = |i: usize, j: usize, k: usize| orient2d(points[i], points[j], points[k]) == Sign::Positive;
    ccw(a, b, d) && ccw(b, d, c) && ccw(d, c, a) && ccw(c, a, b)
}

/// What becomes of a start under all orders of flips.
#[derive(Default)]
struct Outcome {
    ends: BTreeSet<Mesh>,
    meshes: usize,
    all_convex: bool,
    cycle: bool,
}

/// Depth first through everything that flips can reach. A mesh met again on the way to itself is a cycle.
fn explore(points: &[DVec2], start: Mesh, fixed: &[[usize; 2]], rule: Rule) -> Outcome {
    let mut outcome = Outcome { all_convex: true, ..Outcome::default() };
    let mut done: HashSet<Mesh> = HashSet::new();
    let mut on_path: HashSet<Mesh> = HashSet::new();
    // Each entry twice: once to go on from, once to leave.
    let mut stack = vec![(start, false)];
    while let Some((mesh, leave)) = stack.pop() {
        if leave {
            on_path.remove(&mesh);
            done.insert(mesh);
            continue;
        }
        if done.contains(&mesh) {
            continue;
        }
        let flips = demanded(points, &mesh, fixed, rule);
        if flips.is_empty() {
            outcome.ends.insert(mesh.clone());
        }
        on_path.insert(mesh.clone());
        stack.push((mesh.clone(), true));
        for flip in flips {
            if !strictly_convex(points, flip) {
                outcome.all_convex = false;
                continue;
            }
            let next = flipped(&mesh, flip);
            if on_path.contains(&next) {
                outcome.cycle = true;
            } else {
                stack.push((next, false));
            }
        }
    }
    outcome.meshes = done.len();
    outcome
}

/// Random sets, half of them with constraints, a few starts each; how often there was not one end.
fn failures(rule: Rule, sets: usize, seed: u64) -> (usize, usize) {
    let mut random = Random(seed);
    let (mut failures, mut most) = (0, 0);
    for set in 0..sets {
        let n = 6 + set % 4;
        let points = point_set(&mut random, n);
        let mut fixed = Vec::new();
        if set % 2 == 1 {
            let mut candidates = candidate_edges(&points);
            random.shuffle(&mut candidates);
            for e in candidates.into_iter().take(4) {
                if fixed.iter().all(|&f| !cross(&points, e, f)) {
                    fixed.push(e);
                }
            }
        }
        let mut ends = BTreeSet::new();
        let mut good = true;
        for _ in 0..3 {
            let outcome = explore(&points, random_start(&mut random, &points, &fixed), &fixed, rule);
            good &= outcome.all_convex && !outcome.cycle;
            most = most.max(outcome.meshes);
            ends.extend(outcome.ends);
        }
        failures += usize::from(!good || ends.len() != 1);
    }
    (failures, most)
}

#[test]
fn all_flips_from_all_starts_end_in_one_triangulation() {
    let (failures, most) = failures(must_flip, 2000, 21);
    assert_eq!(failures, 0);
    assert!(most > 50, "the starts are too close to the end: {most}");
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn all_flips_from_all_starts_end_in_one_triangulation_long() {
    assert_eq!(failures(must_flip, 10_000, 22).0, 0);
}

#[test]
fn wrong_tie_breaks_are_found_out() {
    // None: either diagonal stays.
    assert!(failures(|a, b, c, d| incircle(a, b, c, d) == Sign::Positive, 40, 21).0 > 0);
    // Both diagonals go.
    assert!(failures(|a, b, c, d| incircle(a, b, c, d) != Sign::Negative, 40, 21).0 > 0);
    // The smallest point by distance to the origin, which has ties of its own.
    let nearest: Rule = |a, b, c, d| match incircle(a, b, c, d) {
        Sign::Zero => a.length().min(d.length()) < b.length().min(c.length()),
        sign => sign == Sign::Positive,
    };
    assert!(failures(nearest, 40, 21).0 > 0);
    // One triangle's corner alone.
    let one_sided: Rule = |a, b, c, d| match incircle(a, b, c, d) {
        Sign::Zero => [b, c, d].iter().all(|&p| lexicographic(a, p).is_lt()),
        sign => sign == Sign::Positive,
    };
    assert!(failures(one_sided, 40, 21).0 > 0);
}

/// The sign of the determinant for the heights `|p|² - 2^(-16 k)`, `k` the rank of `p`, by big integers. All
/// determinants here are below 2^12, so that each height decides before the next.
fn lifted(points: &[DVec2], q: [usize; 4]) -> Sign {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| lexicographic(points[i], points[j]));
    let height = |i: usize| {
        let rank = order.iter().position(|&j| j == i).unwrap();
        (IBig::from(points[i].length_squared() as i64) << 256) - (IBig::ONE << (256 - 16 * (rank + 1)))
    };
    let bracket =
        |i: usize, j: usize, k: usize| IBig::from((points[j] - points[i]).perp_dot(points[k] - points[i]) as i64);
    let [a, b, c, d] = q;
    let value = height(a) * bracket(b, c, d) + height(b) * bracket(c, a, d) + height(c) * bracket(a, b, d)
        - height(d) * bracket(a, b, c);
    match value.cmp(&IBig::ZERO) {
        Ordering::Less => Sign::Negative,
        Ordering::Equal => Sign::Zero,
        Ordering::Greater => Sign::Positive,
    }
}

#[test]
fn the_sign_is_that_of_the_perturbed_lifting() {
    let mut random = Random(23);
    let (mut ties, mut zeros) = (0, 0);
    for _ in 0..3000 {
        let points = point_set(&mut random, 6);
        for (p, _) in permutations() {
            let [a, b, c, d] = p.map(|i| points[i]);
            let sign = incircle_canonical(a, b, c, d);
            assert_eq!(sign, lifted(&points, p), "{a} {b} {c} {d}");
            ties += usize::from(incircle(a, b, c, d) == Sign::Zero);
            zeros += usize::from(sign == Sign::Zero);
            let triangles = [orient2d(a, b, c), orient2d(d, c, b)];
            if triangles == [Sign::Positive; 2] {
                assert_eq!(must_flip(a, b, c, d), sign == Sign::Positive);
                assert_eq!(must_flip(a, b, c, d), must_flip(d, c, b, a));
            }
        }
    }
    // Many ties, and hardly a zero: only four points on a line.
    assert!(ties > 1000 && zeros < ties / 2, "{ties} {zeros}");
}

#[test]
fn the_end_is_the_lower_hull_of_the_perturbed_lifting() {
    let mut random = Random(24);
    let largest: Rule = |a, b, c, d| match incircle(a, b, c, d) {
        Sign::Zero => {
            let larger = |p: DVec2, q: DVec2| if lexicographic(p, q).is_gt() { p } else { q };
            lexicographic(larger(a, d), larger(b, c)).is_gt()
        }
        sign => sign == Sign::Positive,
    };
    let mut different = 0;
    for set in 0..100 {
        let n = 5 + set % 5;
        let points = point_set(&mut random, n);
        let mut hull = Mesh::new();
        for t in (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..n).map(move |k| [i, j, k]))) {
            let [i, j, k] = t;
            if i < j
                && i < k
                && orient2d(points[i], points[j], points[k]) == Sign::Positive
                && (0..n).all(|v| t.contains(&v) || lifted(&points, [i, j, k, v]) == Sign::Negative)
            {
                hull.insert(t);
            }
        }
        let start = random_start(&mut random, &points, &[]);
        let end = |rule: Rule| explore(&points, start.clone(), &[], rule).ends.into_iter().next();
        assert_eq!(end(must_flip).as_ref(), Some(&hull), "{points:?}");
        different += usize::from(end(largest).as_ref() != Some(&hull));
    }
    // The largest point instead of the smallest: also one end, but another one.
    assert!(different > 0);
}

#[test]
fn a_tie_has_one_answer_in_any_order_and_at_any_scale() {
    let mut random = Random(25);
    let circle = pythagorean();
    for _ in 0..3000 {
        let mut q: [(i64, i64); 4] = std::array::from_fn(|_| random.pick(&circle));
        q.sort_unstable();
        if q.windows(2).any(|w| w[0] == w[1]) {
            continue;
        }
        let scale = random.integer(-1074, 1000) as i32;
        let q = q.map(|(x, y)| dvec2(x as f64, y as f64).map(|x| common::ldexp(x, scale)));
        // The smallest point comes first here: inside, if d is it.
        let [d, a, b, c] = q;
        let expected = orient2d(a, b, c);
        assert_ne!(expected, Sign::Zero);
        for (p, even) in permutations() {
            let [a, b, c, d] = p.map(|i| [a, b, c, d][i]);
            assert_eq!(incircle(a, b, c, d), Sign::Zero);
            assert_eq!(incircle_canonical(a, b, c, d), if even { expected } else { -expected }, "{q:?} {p:?}");
        }
    }
}

#[test]
fn the_lexicographic_order_is_total_and_knows_no_minus_zero() {
    let values = [0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let points: Vec<DVec2> = values.iter().flat_map(|&x| values.map(|y| dvec2(x, y))).collect();
    for &p in &points {
        for &q in &points {
            let order = lexicographic(p, q);
            assert_eq!(order, lexicographic(q, p).reverse());
            if !p.is_nan() && !q.is_nan() {
                let expected = p.x.partial_cmp(&q.x).unwrap().then(p.y.partial_cmp(&q.y).unwrap());
                assert_eq!(order, expected, "{p} {q}");
            }
            for &r in &points {
                if order.is_le() && lexicographic(q, r).is_le() {
                    assert!(lexicographic(p, r).is_le());
                }
            }
        }
    }
}

#[test]
fn equal_points_and_lines_give_zero() {
    let (a, b, c) = (dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(0.0, 4.0));
    for d in [a, b, c] {
        assert_eq!(incircle_canonical(a, b, c, d), Sign::Zero);
    }
    assert_eq!(incircle_canonical(a, b, c, dvec2(-0.0, 0.0)), Sign::Zero);
    let line = [0.0, 1.0, 3.0, 9.0].map(|t| dvec2(t, 2.0 * t));
    assert_eq!(incircle_canonical(line[0], line[1], line[2], line[3]), Sign::Zero);
}
