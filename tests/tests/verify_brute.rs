//! The checker against brute force: tiny meshes on a lattice, some of them damaged, judged by definition.
#![allow(clippy::unwrap_used, reason = "tests")]

mod verify_support;

use polder::verify;
use polder_mesh::Pslg;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64;
use verify_support::by_spade;

type P = [i64; 2];

fn area(a: P, b: P, c: P) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether d lies inside the circle through the counterclockwise a, b, c.
fn inside(a: P, b: P, c: P, d: P) -> bool {
    let [r, s, t] = [a, b, c].map(|p| {
        let [x, y] = [p[0] - d[0], p[1] - d[1]];
        [x, y, x * x + y * y]
    });
    let minor = |i: usize, j: usize| s[i] * t[j] - s[j] * t[i];
    r[0] * minor(1, 2) - r[1] * minor(0, 2) + r[2] * minor(0, 1) > 0
}

fn cross(a: P, b: P, c: P, d: P) -> bool {
    area(a, b, c).signum() * area(a, b, d).signum() < 0 && area(c, d, a).signum() * area(c, d, b).signum() < 0
}

/// Whether q lies on the segment ab, ends excluded.
fn on(a: P, b: P, q: P) -> bool {
    area(a, b, q) == 0 && (0..2).map(|i| (q[i] - a[i]) * (b[i] - q[i])).sum::<i64>() > 0
}

/// Whether no point lies in the inside of both triangles: some edge has the other triangle on its right.
fn disjoint(t: [P; 3], u: [P; 3]) -> bool {
    let splits = |t: [P; 3], u: [P; 3]| (0..3).any(|k| u.iter().all(|&q| area(t[k], t[(k + 1) % 3], q) <= 0));
    splits(t, u) || splits(u, t)
}

/// Twice the area of the convex hull: a walk along it, from its lowest point on.
fn hull_area(points: &[P]) -> i64 {
    let edges = points.iter().flat_map(|&a| points.iter().map(move |&b| (a, b)));
    let is_hull = |&(a, b): &(P, P)| {
        a != b && points.iter().all(|&q| area(a, b, q) > 0 || area(a, b, q) == 0 && !beyond(a, b, q))
    };
    edges.filter(is_hull).map(|(a, b)| area([0, 0], a, b)).sum()
}

/// Whether q lies on the line ab, but outside the segment.
fn beyond(a: P, b: P, q: P) -> bool {
    q != a && q != b && !on(a, b, q)
}

/// A constrained Delaunay triangulation by definition: counterclockwise triangles of points, no two overlapping, that
/// together have the hull's area, no vertex in an edge, none unused, no edge across a constraint; and no vertex inside
/// the circle of a triangle across an edge that lies on no constraint (any vertex, if there are no constraints).
fn is_cdt(points: &[P], constraints: &[[u32; 2]], triangles: &[[u32; 3]]) -> bool {
    if triangles.iter().flatten().any(|&v| v as usize >= points.len()) {
        return false;
    }
    let at = |v: u32| points[v as usize];
    let all: Vec<[P; 3]> = triangles.iter().map(|t| t.map(at)).collect();
    let edges: Vec<[P; 2]> = all.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let segments: Vec<[P; 2]> = constraints.iter().map(|c| c.map(at)).collect();
    let on_segment =
        |[a, b]: [P; 2]| segments.iter().any(|&[c, d]| [a, b].iter().all(|&q| q == c || q == d || on(c, d, q)));
    all.iter().all(|&[a, b, c]| area(a, b, c) > 0)
        && all.iter().enumerate().all(|(i, &t)| all[..i].iter().all(|&u| disjoint(t, u)))
        && all.iter().map(|&[a, b, c]| area(a, b, c)).sum::<i64>() == hull_area(points)
        && edges.iter().all(|&[a, b]| points.iter().all(|&q| !on(a, b, q)))
        && (points.iter().all(|p| all.iter().flatten().any(|q| p == q)) || all.is_empty())
        && edges.iter().all(|&[a, b]| segments.iter().all(|&[c, d]| !cross(a, b, c, d)))
        && all.iter().all(|&[a, b, c]| {
            if segments.is_empty() {
                return points.iter().all(|&q| !inside(a, b, c, q));
            }
            [[a, b], [b, c], [c, a]].iter().filter(|&&edge| !on_segment(edge)).all(|&[from, to]| {
                let across = all.iter().filter(|t| (0..3).any(|k| t[k] == to && t[(k + 1) % 3] == from));
                across.copied().flatten().all(|q| !inside(a, b, c, q))
            })
        })
}

struct Random(Pcg64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n.max(1) as u64) as usize
    }
}

/// Distinct lattice points, and constraints that do not cross.
fn input(random: &mut Random) -> (Vec<P>, Vec<[u32; 2]>) {
    let n = 3 + random.below(7);
    let mut points: Vec<P> = Vec::new();
    while points.len() < n {
        let p = [random.below(6) as i64 - 2, random.below(5) as i64];
        if !points.contains(&p) {
            points.push(p);
        }
    }
    let mut constraints: Vec<[u32; 2]> = Vec::new();
    for _ in 0..random.below(5) {
        let new = [random.below(n), random.below(n)].map(|v| v as u32);
        let at = |c: [u32; 2]| c.map(|v| points[v as usize]);
        let [a, b] = at(new);
        if a != b && constraints.iter().all(|&c| !cross(a, b, at(c)[0], at(c)[1])) {
            constraints.push(new);
        }
    }
    (points, constraints)
}

fn damage(triangles: &mut Vec<[u32; 3]>, points: usize, random: &mut Random) {
    let n = triangles.len();
    let Some(&[a, b, c]) = triangles.get(random.below(n)) else { return };
    let t = triangles.iter().position(|&t| t == [a, b, c]).unwrap();
    match random.below(7) {
        0 => drop(triangles.remove(t)),
        1 => triangles[t].swap(0, 1),
        2 => triangles.push([b, c, a]),
        3 => triangles[t][0] = random.below(points + 1) as u32,
        4 => triangles.push([a, b, random.below(points) as u32]),
        _ => {
            let apex = |t: &[u32; 3]| (0..3).find(|&k| t[k] == c && t[(k + 1) % 3] == b).map(|k| t[(k + 2) % 3]);
            if let Some((u, d)) = triangles.iter().enumerate().find_map(|(u, t)| Some((u, apex(t)?))) {
                (triangles[t], triangles[u]) = ([a, b, d], [a, d, c]);
            }
        }
    }
}

#[test]
fn the_checker_agrees_with_the_definition() {
    let mut random = Random(Pcg64::seed_from_u64(1));
    let (mut valid, mut damaged_but_valid, mut invalid) = (0, 0, 0);
    for case in 0..20_000 {
        let (points, constraints) = input(&mut random);
        let pslg = Pslg::new(points.iter().map(|&[x, y]| (x as f64, y as f64).into()).collect(), constraints.clone());
        let pslg = pslg.unwrap();
        let Some(mut triangles) = by_spade(&pslg) else { continue };
        let damages = random.below(4);
        (0..damages).for_each(|_| damage(&mut triangles, points.len(), &mut random));

        let verdict = verify::check(&pslg, &triangles);
        let right = is_cdt(&points, &constraints, &triangles);
        assert_eq!(verdict.is_valid(), right, "case {case}: {points:?} {constraints:?} {triangles:?}: {verdict}");
        match (right, damages) {
            (true, 0) => valid += 1,
            (true, _) => damaged_but_valid += 1,
            _ => invalid += 1,
        }
    }
    assert!(valid > 1000 && damaged_but_valid > 500 && invalid > 5000, "{valid} {damaged_but_valid} {invalid}");
}

#[test]
fn garbage_is_judged_without_a_panic() {
    let mut random = Random(Pcg64::seed_from_u64(2));
    let coordinates = [0.0, -0.0, 1.0, -1.0, 0.5, f64::MAX, f64::MIN, f64::from_bits(1), 1e-300, 1e300, 3.0];
    for _ in 0..5000 {
        let n = random.below(8);
        let mut pick = || coordinates[random.below(coordinates.len())];
        let points = (0..n).map(|_| (pick(), pick()).into()).collect();
        let ends = |random: &mut Random| [random.below(n), random.below(n)].map(|v| v as u32);
        let constraints = if n == 0 { vec![] } else { (0..random.below(4)).map(|_| ends(&mut random)).collect() };
        let pslg = Pslg::new(points, constraints).unwrap();
        let corner = |random: &mut Random| if random.below(40) == 0 { u32::MAX } else { random.below(n + 1) as u32 };
        let count = random.below(9);
        let triangles: Vec<_> = (0..count).map(|_| [(); 3].map(|()| corner(&mut random))).collect();
        let verdict = verify::check(&pslg, &triangles);
        assert!(!verdict.to_string().is_empty());
    }
}
