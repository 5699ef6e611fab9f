//! Constraints that cross are cut: what comes out is the canonical triangulation of the pieces, whatever the order and
//! direction of the constraints.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder::constrain::reference::intersection;
use polder::{Backend, ConstraintId, CrossingPolicy, DVec2, Error, Options, Output, Pslg, triangulate, verify};
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn splitting() -> Options {
    Options { crossings: CrossingPolicy::Split, ..Options::default() }
}

fn p(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// Splits, and checks all that holds for every input.
fn checked(name: &str, pslg: &Pslg) -> Output {
    let output = triangulate(pslg, &splitting()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mesh = &output.triangulation;
    let added = mesh.added();
    let mut points = pslg.points().to_vec();
    points.extend(added.iter().map(|vertex| vertex.position));
    assert_eq!(mesh.representatives().len(), points.len(), "{name}");

    // The pieces are the constraints of the result, and it is the canonical one of these.
    let pieces: Vec<[u32; 2]> = mesh.chains().iter().flat_map(|chain| chain.windows(2)).map(|w| [w[0], w[1]]).collect();
    let cut = Pslg::new(points.clone(), pieces).unwrap();
    assert!(verify::check(&cut, mesh.triangles()).is_canonical(), "{name}");

    // New vertices are in order, differ from all others, and know their constraints.
    let order = |v: &polder::AddedVertex| (v.round, v.position.x, v.position.y);
    assert!(added.windows(2).all(|w| order(&w[0]) < order(&w[1])), "{name}");
    let first = pslg.points().len() as u32;
    for (i, vertex) in added.iter().enumerate() {
        let v = first + i as u32;
        assert_eq!(mesh.representatives()[v as usize], v, "{name}");
        let through = |c: &ConstraintId| mesh.chain(*c).contains(&v);
        let all = (0..pslg.constraints().len() as u32).map(ConstraintId);
        assert_eq!(vertex.parents, all.filter(through).collect::<Vec<_>>(), "{name}");
        assert!(vertex.parents.len() >= 2, "{name}: {vertex:?}");
    }
    // Chains run from end to end, never back.
    for (constraint, chain) in pslg.constraints().iter().zip(mesh.chains().iter()) {
        let of = mesh.representatives();
        let ends = constraint.map(|v| of[v as usize]);
        assert_eq!([chain[0], chain[chain.len() - 1]], ends, "{name}");
        let d = points[ends[1] as usize] - points[ends[0] as usize];
        for w in chain.windows(2) {
            let step = points[w[1] as usize] - points[w[0] as usize];
            assert!(step.x * d.x.signum() >= 0.0 && step.y * d.y.signum() >= 0.0, "{name}: {chain:?}");
        }
    }
    assert_eq!(output.report.points.added, added.len());
    assert_eq!(output.report.points.total, pslg.points().len());
    output
}

/// Checks, and that order and direction of the constraints do not show.
fn same_in_any_order(name: &str, points: Vec<DVec2>, constraints: Vec<[u32; 2]>) -> Output {
    let output = checked(name, &Pslg::new(points.clone(), constraints.clone()).unwrap());
    let turned = constraints.iter().rev().enumerate().map(|(i, &[a, b])| if i % 2 == 0 { [b, a] } else { [a, b] });
    let other = triangulate(&Pslg::new(points.clone(), turned.collect()).unwrap(), &splitting()).unwrap();
    let mut shuffled = constraints;
    let mut random = Random::new(shuffled.len() as u64);
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, random.0.next_u32() as usize % (i + 1));
    }
    let third = triangulate(&Pslg::new(points, shuffled).unwrap(), &splitting()).unwrap();
    let mesh = &output.triangulation;
    for again in [other.triangulation, third.triangulation] {
        assert_eq!(mesh.triangles(), again.triangles(), "{name}");
        assert_eq!(mesh.constrained_bits(), again.constrained_bits(), "{name}");
        assert_eq!(mesh.digest(), again.digest(), "{name}");
    }
    output
}

struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    fn point(&mut self) -> DVec2 {
        p(self.unit(), self.unit())
    }
}

/// Constraints between successive pairs of points.
fn pairs(count: usize) -> Vec<[u32; 2]> {
    (0..count as u32 / 2).map(|i| [2 * i, 2 * i + 1]).collect()
}

#[test]
fn two_diagonals_get_a_vertex() {
    let points = vec![p(0., 0.), p(4., 0.), p(4., 3.), p(0., 3.)];
    let output = same_in_any_order("box", points, vec![[0, 2], [3, 1], [0, 1]]);
    let mesh = &output.triangulation;
    assert_eq!(mesh.triangles(), [[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4]]);
    assert_eq!((mesh.added()[0].position, mesh.added()[0].round), (p(2.0, 1.5), 1));
    assert_eq!(mesh.added()[0].parents, [0, 1].map(ConstraintId));
    assert_eq!(mesh.chains().iter().collect::<Vec<_>>(), [&[0, 4, 2][..], &[3, 4, 1], &[0, 1]]);
    // Positions are part of the digest.
    let wide = Pslg::new(vec![p(0., 0.), p(8., 0.), p(8., 6.), p(0., 6.)], vec![[0, 2], [3, 1]]).unwrap();
    let wide = triangulate(&wide, &splitting()).unwrap().triangulation;
    assert_eq!(wide.triangles(), mesh.triangles());
    assert_ne!(wide.digest(), mesh.digest());
}

#[test]
fn what_does_not_cross_is_as_without() {
    for (name, pslg) in polder_tests::families(300, 5) {
        let plain = triangulate(&pslg, &Options::default()).unwrap().triangulation;
        assert_eq!(triangulate(&pslg, &splitting()).unwrap().triangulation, plain, "{name}");
        assert!(plain.added().is_empty());
    }
}

#[test]
fn scattered_crossings() {
    let mut random = Random::new(1);
    for count in [4, 10, 40, 200] {
        for _ in 0..6 {
            let points: Vec<DVec2> = (0..count).map(|_| random.point()).collect();
            let output = same_in_any_order("scattered", points.clone(), pairs(count));
            for vertex in output.triangulation.added().iter().filter(|v| v.round == 1 && v.parents.len() == 2) {
                let line = |i: usize| [0, 1].map(|k| points[2 * vertex.parents[i].index() + k]);
                assert_eq!(Some(vertex.position), intersection(line(0), line(1)));
            }
        }
    }
}

#[test]
fn lattice_lines_cross_in_vertices_overlap_and_repeat() {
    let mut random = Random::new(2);
    for round in 0..60 {
        let side = 3.0 + f64::from(round % 9);
        let count = 6 + 2 * (round as usize % 14);
        let points: Vec<DVec2> = (0..count).map(|_| (random.point() * side).round()).collect();
        let mut constraints = pairs(count);
        constraints.extend(constraints.clone().into_iter().step_by(3));
        same_in_any_order("lattice", points, constraints);
    }
}

/// Bundles of lines that are a few last places apart over their whole length. Rounding bends their pieces across each
/// other again; cut at their crossings alone, a twentieth of them would not come to an end.
#[test]
fn nearly_parallel_lines_and_crossings_at_one_ulp() {
    let mut random = Random::new(3);
    let ulp = f64::EPSILON;
    let (mut again, mut most) = (0, 0);
    for round in 0..120 {
        let lines = 2 + round % 12;
        let mut points = Vec::new();
        for i in 0..lines {
            let jiggle = |random: &mut Random| f64::from(random.0.next_u32() % 7) * ulp * 2f64.powi(round % 5);
            let (from, to) = (jiggle(&mut random), jiggle(&mut random));
            // From left to right, the one a little above, the other a little below; some shifted along.
            let shift = f64::from(i % 3) * 0.1;
            points.extend([p(1.0 + shift, 1.0 + from), p(2.0 - shift, 1.0 + to)]);
        }
        let turned: Vec<DVec2> = points.iter().map(|q| p(q.x + q.y, q.y - q.x)).collect();
        for points in [points, turned] {
            let output = same_in_any_order("nearly parallel", points.clone(), pairs(points.len()));
            let added = output.triangulation.added();
            again += u32::from(added.iter().any(|vertex| vertex.round > 1));
            most = most.max(added.len());
        }
    }
    assert!(again > 3 && most < 60, "{again} crossed again, {most} added vertices");
}

/// The same in any direction, at any place and of any size, with a spread of 1 to 2048 last places.
#[test]
fn bundles_anywhere() {
    for seed in 0..200 {
        let mut random = Random::new(1000 + seed);
        let scale = 2f64.powi((random.unit() * 40.0) as i32 - 20);
        let [a, mut b] = [(); 2].map(|()| (random.point() - DVec2::splat(0.5)) * scale);
        if seed % 3 == 0 {
            b.y = a.y;
        }
        let spread = 1 << (random.0.next_u32() % 12);
        let mut off = |x: f64| f64::from_bits(x.to_bits() + u64::from(random.0.next_u32() % spread));
        let mut points = Vec::new();
        for i in 0..2 + seed % 11 {
            let t = 0.07 * (i % 4) as f64;
            let (q, r) = (a + (b - a) * t, b - (b - a) * t * 0.5);
            points.extend([p(off(q.x), off(q.y)), p(off(r.x), off(r.y))]);
        }
        let output = same_in_any_order("bundle", points.clone(), pairs(points.len()));
        let added = output.triangulation.added();
        // Each round moves an edge by half a last place at most.
        assert!(added.iter().all(|vertex| vertex.round < 8) && added.len() < 300, "{seed}: {added:?}");
        for (i, line) in points.chunks(2).enumerate() {
            let size = line.iter().fold(DVec2::ZERO, |size, q| size.max(q.abs()));
            let reach = size * 8.0 * f64::EPSILON;
            for &v in output.triangulation.chain(ConstraintId(i as u32)) {
                let q = output.triangulation.added().get((v as usize).wrapping_sub(points.len()));
                let q = q.map_or_else(|| points[v as usize], |vertex| vertex.position);
                let d = line[1] - line[0];
                let side = d.perp_dot(q - line[0]).abs();
                assert!(side <= d.abs().dot(p(reach.y, reach.x)), "{seed}: {q} is not on {line:?}");
            }
        }
    }
}

#[test]
fn two_lines_that_cross_within_a_last_place() {
    let up = f64::next_up;
    for (x, y) in [(1.0, 1.0), (0.3, -0.7), (1e-300, 3e-301), (-5e5, 1e-3), (0.0, 1.0)] {
        // From below to above by one number, over a long way and a short one.
        for far in [x + 1.0, up(up(up(x)))] {
            let points = vec![p(x, y), p(far, up(y)), p(x, up(y)), p(far, y), p(x, up(up(y))), p(far, y)];
            same_in_any_order("one last place", points, pairs(6));
        }
    }
}

#[test]
fn many_lines_through_nearly_one_point() {
    for (lines, jitter) in [(3, 0.0), (30, 0.0), (30, 1e-15), (60, 1e-12), (60, 1e-9)] {
        let mut random = Random::new(lines as u64);
        let center = p(1.0 / 3.0, 0.7);
        let mut points = Vec::new();
        for i in 0..lines {
            let d = DVec2::from_angle(std::f64::consts::PI * f64::from(i) / f64::from(lines));
            let off = (random.point() - DVec2::splat(0.5)) * jitter;
            points.extend([center + d + off, center - d * 0.7 + off]);
        }
        let output = same_in_any_order("star", points.clone(), pairs(points.len()));
        assert!(!output.triangulation.added().is_empty());
    }
}

#[test]
fn any_magnitude() {
    let mut random = Random::new(6);
    for scale in [1e300, 1e-300, 2f64.powi(-1070), 1e150] {
        let points: Vec<DVec2> = (0..40).map(|_| (random.point() - DVec2::splat(0.5)) * scale).collect();
        same_in_any_order("scaled", points, pairs(40));
    }
    let points = vec![p(-1e300, -1e-300), p(1e300, 1e-300), p(-1e-300, 1e300), p(1e-300, -1e300), p(1.0, 2.0)];
    same_in_any_order("mixed", points, vec![[0, 1], [2, 3], [4, 0], [4, 3]]);
    let huge = f64::MAX;
    let points = vec![p(-huge, -huge), p(huge, huge), p(-huge, huge), p(huge, -huge)];
    let output = same_in_any_order("huge", points, vec![[0, 1], [2, 3]]);
    assert_eq!(output.triangulation.added()[0].position, DVec2::ZERO);
}

#[test]
fn every_backend_splits_alike() {
    let mut random = Random::new(7);
    for count in [20, 60] {
        let points: Vec<DVec2> = (0..count).map(|_| random.point()).collect();
        let pslg = Pslg::new(points, pairs(count)).unwrap();
        let by = |backend| triangulate(&pslg, &Options { backend, ..splitting() }).unwrap().triangulation;
        assert_eq!(by(Backend::Cpu), by(Backend::Reference));
    }
}

#[test]
fn too_many_is_an_error() {
    let points: Vec<DVec2> =
        (0..10).flat_map(|i| [p(f64::from(i), -1.0), p(9.0 - f64::from(i * i) / 9.0, 1.0)]).collect();
    let pslg = Pslg::new(points, pairs(20)).unwrap();
    let limited = |max_added_vertices| triangulate(&pslg, &Options { max_added_vertices, ..splitting() });
    assert!(matches!(limited(5), Err(Error::SplitTooLarge { limit: 5, .. })));
    let added = limited(1000).unwrap().triangulation.added().len();
    assert!(limited(added).is_ok() && limited(added - 1).is_err());
    assert!(matches!(triangulate(&pslg, &Options::default()), Err(Error::CrossingConstraints { .. })));
}
