//! Each path alone: where it answers, it answers right, and each has input that needs it.

mod common;

use common::{Random, exact_incircle, exact_orient2d, families, ldexp, mixed_magnitudes};
use glam::{DVec2, dvec2};
use polder_predicates::limbs::{MAX_INCIRCLE_LIMBS, MAX_ORIENT2D_LIMBS, Span};
use polder_predicates::wide::{INCIRCLE_BOUND, ORIENT2D_BOUND};
use polder_predicates::{Sign, expansions, filter, integers, limbs, wide};

/// How many calls of a family each path decides, in the order of the ladder.
#[derive(Debug, Default, PartialEq)]
struct Decided {
    calls: usize,
    filter: usize,
    integers: usize,
    expansions: usize,
    wide: usize,
}

impl Decided {
    fn check(&mut self, expected: Sign, answers: [Option<Sign>; 5], what: &str) {
        self.calls += 1;
        let counts = [&mut self.filter, &mut self.integers, &mut self.expansions, &mut self.wide];
        for (path, answer) in answers.iter().enumerate() {
            assert!(
                answer.is_none_or(|sign| sign == expected),
                "path {path} of {what} says {answer:?}, not {expected:?}"
            );
        }
        for (count, answer) in counts.into_iter().zip(answers) {
            *count += usize::from(answer.is_some());
        }
    }
}

#[test]
fn all_paths_agree_wherever_they_answer() {
    let mut found = Vec::new();
    for family in families(1500, 11) {
        let (mut orient2d, mut incircle) = (Decided::default(), Decided::default());
        for &[a, b, c, d] in &family.quadruples {
            orient2d.check(
                exact_orient2d([a, b, c]),
                [
                    filter::orient2d(a, b, c),
                    integers::orient2d(a, b, c),
                    expansions::orient2d(a, b, c),
                    wide::orient2d(a, b, c),
                    Some(limbs::orient2d(a, b, c)),
                ],
                &format!("orient2d {}: {a} {b} {c}", family.name),
            );
            incircle.check(
                exact_incircle([a, b, c, d]),
                [
                    filter::incircle(a, b, c, d),
                    integers::incircle(a, b, c, d),
                    expansions::incircle(a, b, c, d),
                    wide::incircle(a, b, c, d),
                    Some(limbs::incircle(a, b, c, d)),
                ],
                &format!("incircle {}: {a} {b} {c} {d}", family.name),
            );
        }
        found.push((family.name, orient2d, incircle));
    }
    let of = |name: &str| found.iter().find(|f| f.0 == name).map(|f| (&f.1, &f.2)).expect("a family of that name");

    // The filter decides scattered points, and only those.
    let (orient2d, incircle) = of("random");
    assert!(orient2d.filter >= orient2d.calls - 1 && incircle.filter >= incircle.calls - 3);
    assert_eq!(of("lattice").1.filter, 0);
    // Machine integers decide every lattice and nearly every circle.
    for name in ["lattice", "integer circle", "integer circle far away", "collinear integers", "corners of 29 bits"] {
        assert_eq!(of(name).1.integers, 1500, "{name}");
        assert_eq!(of(name).0.integers, 1500, "{name}");
    }
    assert!(of("rounded circle").1.integers > 1400);
    // Expansions, brought into their window, decide what lies far from 1, and not what has no common scale.
    for name in ["1e300", "1e-300", "subnormal"] {
        assert_eq!(of(name).1.expansions, 1500, "{name}");
    }
    let (_, mixed) = of("all exponents");
    assert!(mixed.expansions < 200 && mixed.integers < 200);
    // Wide exponents do, unless it is a close call.
    for name in ["all exponents", "mixed magnitudes", "three points together and one far away", "random", "1e300"] {
        let (orient2d, incircle) = of(name);
        assert!(orient2d.wide > 1480 && incircle.wide > 1480, "{name}: {orient2d:?} {incircle:?}");
    }
    let (orient2d, _) = of("near a line, x far larger than y");
    assert!(orient2d.wide < orient2d.calls / 2, "{orient2d:?}");
}

/// The expansions taken outside their window are wrong: the window is needed.
#[test]
fn expansions_err_outside_their_window() {
    let coordinates = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    for name in ["subnormal", "1e-300", "1e300", "products near the smallest double"] {
        let family = families(300, 12).into_iter().find(|f| f.name == name).expect("a family of that name");
        let wrong = family.quadruples.iter().filter(|&&q| {
            let [a, b, c, d] = q.map(coordinates);
            let value = robust::incircle(a, b, c, d);
            let sign = match value.partial_cmp(&0.0) {
                Some(std::cmp::Ordering::Less) => Sign::Negative,
                Some(std::cmp::Ordering::Greater) => Sign::Positive,
                _ => Sign::Zero,
            };
            sign != exact_incircle(q)
        });
        assert!(wrong.count() > 0, "{name}");
    }
}

/// The filter without the part of its bound that covers underflow.
fn filter_without_underflow([a, b, c, d]: [DVec2; 4]) -> Option<Sign> {
    let (a, b, c) = (a - d, b - d, c - d);
    let lift = |p: DVec2| p.x * p.x + p.y * p.y;
    let minor = |p: DVec2, q: DVec2| p.x * q.y - q.x * p.y;
    let value = lift(a) * minor(b, c) + lift(b) * minor(c, a) + lift(c) * minor(a, b);
    let bound = 6.0 * f64::EPSILON * (lift(a) * lift(b) + (lift(a) + lift(b)) * lift(c));
    (value.abs() > bound).then_some(if value > 0.0 { Sign::Positive } else { Sign::Negative })
}

#[test]
fn the_filter_needs_its_underflow_term() {
    let mut random = Random(13);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let exponent = random.integer(-300, -240) as i32;
        let q =
            std::array::from_fn(|_| dvec2(ldexp(random.unit() - 0.5, exponent), ldexp(random.unit() - 0.5, exponent)));
        let expected = exact_incircle(q);
        wrong += u32::from(filter_without_underflow(q).is_some_and(|sign| sign != expected));
        assert!(filter::incircle(q[0], q[1], q[2], q[3]).is_none_or(|sign| sign == expected), "{q:?}");
    }
    assert!(wrong > 0);
}

/// A bound that is too small by a factor of sixteen lets wrong signs through: the tests would notice.
#[test]
fn a_filter_with_too_small_a_bound_errs() {
    let mut random = Random(14);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let q: [DVec2; 4] = std::array::from_fn(|_| {
            let (sin, cos) = (random.unit() * std::f64::consts::TAU).sin_cos();
            dvec2(cos + 0.3, sin + 0.7)
        });
        let [a, b, c] = [q[0] - q[3], q[1] - q[3], q[2] - q[3]];
        let (la, lb, lc) = (a.length_squared(), b.length_squared(), c.length_squared());
        let value = la * b.perp_dot(c) + lb * c.perp_dot(a) + lc * a.perp_dot(b);
        let bound = 6.0 * f64::EPSILON / 16.0 * (la * lb + (la + lb) * lc);
        let claimed = if value > 0.0 { Sign::Positive } else { Sign::Negative };
        let expected = exact_incircle(q);
        wrong += u32::from(value.abs() > bound && claimed != expected);
        assert!(filter::incircle(q[0], q[1], q[2], q[3]).is_none_or(|sign| sign == expected));
    }
    assert!(wrong > 0);
}

/// Neighbors along an axis among many points of mixed magnitudes: what a triangulation of them asks.
#[test]
fn wide_exponents_decide_neighbors_of_mixed_magnitudes() {
    let mut random = Random(16);
    let mut points: Vec<DVec2> = (0..20_000).map(|_| mixed_magnitudes(&mut random)).collect();
    let (mut calls, mut orient2d, mut incircle) = (0, 0, 0);
    for axis in [0, 1] {
        points.sort_unstable_by(|p, q| p[axis].total_cmp(&q[axis]));
        for (k, q) in points.windows(4).enumerate() {
            let [a, b, c, d] = [q[0], q[1], q[2], q[3]];
            let signs = (wide::orient2d(a, b, c), wide::incircle(a, b, c, d));
            calls += 1;
            orient2d += u32::from(signs.0.is_some());
            incircle += u32::from(signs.1.is_some());
            if k % 20 == 0 {
                assert!(signs.0.is_none_or(|sign| sign == exact_orient2d([a, b, c])), "{q:?}");
                assert!(signs.1.is_none_or(|sign| sign == exact_incircle([a, b, c, d])), "{q:?}");
            }
        }
    }
    assert!(orient2d * 1000 > calls * 999 && incircle * 1000 > calls * 999, "{orient2d} {incircle} of {calls}");
}

#[test]
fn wide_exponents_from_one_base_alone_decide_less() {
    let family = families(1000, 17).into_iter().find(|f| f.name.starts_with("three points together"));
    let family = family.expect("a family of that name");
    let decided = |turn: usize| {
        let from = |q: &&[DVec2; 4]| {
            let [a, b, c, d] = std::array::from_fn(|k| q[(k + turn) % 4]);
            wide::estimate_incircle(a, b, c, d).sign(INCIRCLE_BOUND).is_some()
        };
        family.quadruples.iter().filter(from).count()
    };
    for turn in 0..4 {
        let n = decided(turn);
        // All but those whose base is the point far away.
        assert!((600..850).contains(&n), "{n} from base {turn}");
    }
}

/// Bounds that are too small by a factor of sixteen let wrong signs through: the tests would notice.
#[test]
fn wide_exponents_with_too_small_a_bound_err() {
    let (mut orient2d, mut incircle) = (0, 0);
    for family in families(1500, 18) {
        for &[a, b, c, d] in &family.quadruples {
            let (estimate, expected) = (wide::estimate_orient2d(a, b, c), exact_orient2d([a, b, c]));
            assert!(estimate.sign(ORIENT2D_BOUND).is_none_or(|sign| sign == expected), "{a} {b} {c}");
            orient2d += u32::from(estimate.sign(ORIENT2D_BOUND / 16.0).is_some_and(|sign| sign != expected));
            let (estimate, expected) = (wide::estimate_incircle(a, b, c, d), exact_incircle([a, b, c, d]));
            assert!(estimate.sign(INCIRCLE_BOUND).is_none_or(|sign| sign == expected), "{a} {b} {c} {d}");
            incircle += u32::from(estimate.sign(INCIRCLE_BOUND / 16.0).is_some_and(|sign| sign != expected));
        }
    }
    assert!(orient2d > 0 && incircle > 0, "{orient2d} {incircle}");
}

#[test]
fn wide_exponents_know_exact_zeros_and_what_is_not_finite() {
    let (a, b) = (dvec2(1e300, -1e-300), dvec2(3.0, 5e-324));
    assert_eq!(wide::orient2d(a, b, a), Some(Sign::Zero));
    // Every difference in x is zero, and with it every product.
    let line = [f64::MAX, -f64::MAX, 5e-324, -0.0].map(|y| dvec2(1e-300, y));
    assert_eq!(wide::incircle(line[0], line[1], line[2], line[3]), Some(Sign::Zero));
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (x, y) in [(x, 0.0), (0.0, x), (x, x)] {
            let p = dvec2(x, y);
            assert_eq!(wide::orient2d(a, p, b), None);
            assert_eq!(wide::orient2d(p, p, p), None);
            assert_eq!(wide::incircle(a, b, p, DVec2::ZERO), None);
            assert_eq!(wide::incircle(a, a, a, p), None);
            assert_eq!(wide::incircle(p, p, p, p), None);
        }
    }
}

/// The largest values that each number of bits allows, where a limb too few would show.
#[test]
fn the_limbs_are_enough_for_the_largest_values() {
    let mut random = Random(15);
    for bits in (1..=53).chain([64, 80, 96, 128, 500, 1000, 2000, 2098]) {
        for _ in 0..60 {
            let low = -1074;
            // Full mantissas at the top, and single bits at the bottom.
            let most =
                if bits <= 53 { ldexp(ldexp(1.0, bits) - 1.0, low) } else { ldexp(2.0 - f64::EPSILON, low + bits - 1) };
            let ends = [most, -most, most, -most, ldexp(1.0, low), 0.0];
            let q = std::array::from_fn(|_| dvec2(random.pick(&ends), random.pick(&ends)));
            let [a, b, c, d] = q;
            assert_eq!(limbs::orient2d(a, b, c), exact_orient2d([a, b, c]), "{bits}: {q:?}");
            assert_eq!(limbs::incircle(a, b, c, d), exact_incircle(q), "{bits}: {q:?}");
        }
    }
}

#[test]
fn the_number_of_limbs_follows_the_points_of_the_call() {
    let limbs = |points: &[DVec2]| {
        let span = Span::of(points).expect("finite points");
        (span.bits, span.orient2d_limbs(), span.incircle_limbs())
    };
    assert_eq!(limbs(&[dvec2(0.0, -0.0)]), (0, 1, 1));
    assert_eq!(limbs(&[dvec2(63.0, 0.0)]), (6, 1, 2));
    assert_eq!(limbs(&[dvec2(4095.0, 17.0), dvec2(-4000.0, 0.0)]), (12, 1, 2));
    assert_eq!(limbs(&[dvec2(1.0, 1.0 + f64::EPSILON)]), (53, 4, 7));
    // One stray coordinate makes its own calls long, and no others.
    assert_eq!(limbs(&[dvec2(1.0, 2.0), dvec2(1e-17, 0.0)]).0, 111);
    assert_eq!(limbs(&[dvec2(f64::MAX, 5e-324)]), (2098, MAX_ORIENT2D_LIMBS, MAX_INCIRCLE_LIMBS));
    assert_eq!(Span::of(&[dvec2(f64::INFINITY, 0.0)]), None);
}
