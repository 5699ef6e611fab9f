//! The signs are those of exact arithmetic, for every finite f64.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{
    Random, exact_incircle, exact_orient2d, families, naive_incircle, naive_orient2d, permutations, rational_incircle,
};
use glam::{DVec2, dvec2};
use polder_predicates::{Sign, incircle, orient2d};
use proptest::prelude::*;

#[test]
fn every_family_has_the_exact_signs() {
    check_families(1500, 1);
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn every_family_has_the_exact_signs_long() {
    check_families(100_000, 7);
}

fn check_families(n: usize, seed: u64) {
    for family in families(n, seed) {
        let (mut naive_orient2d_errors, mut naive_incircle_errors) = (0, 0);
        for &[a, b, c, d] in &family.quadruples {
            let orientation = exact_orient2d([a, b, c]);
            assert_eq!(orient2d(a, b, c), orientation, "{}: {a} {b} {c}", family.name);
            naive_orient2d_errors += u32::from(naive_orient2d([a, b, c]) != orientation);
            let inside = exact_incircle([a, b, c, d]);
            assert_eq!(incircle(a, b, c, d), inside, "{}: {a} {b} {c} {d}", family.name);
            naive_incircle_errors += u32::from(naive_incircle([a, b, c, d]) != inside);
        }
        // The families bite: plain f64 does not pass them.
        let name = family.name;
        if family.naive_orient2d_fails {
            assert!(naive_orient2d_errors > 0, "{name} is too easy for orient2d");
        }
        if family.naive_incircle_fails {
            assert!(naive_incircle_errors > 0, "{name} is too easy for incircle");
        }
    }
}

#[test]
fn big_integers_agree_with_rational_numbers() {
    for family in families(20, 2) {
        for q in family.quadruples {
            assert_eq!(exact_incircle(q), rational_incircle(q), "{}: {q:?}", family.name);
        }
    }
}

#[test]
fn exchanging_two_points_changes_the_sign() {
    for family in families(100, 3) {
        for q in &family.quadruples {
            let sign = incircle(q[0], q[1], q[2], q[3]);
            for (p, even) in permutations() {
                let permuted = incircle(q[p[0]], q[p[1]], q[p[2]], q[p[3]]);
                assert_eq!(permuted, if even { sign } else { -sign }, "{}: {q:?} {p:?}", family.name);
            }
            let sign = orient2d(q[0], q[1], q[2]);
            for (i, j, k) in [(1, 2, 0), (2, 0, 1)] {
                assert_eq!(orient2d(q[i], q[j], q[k]), sign, "{}: {q:?}", family.name);
            }
            for (i, j, k) in [(0, 2, 1), (2, 1, 0), (1, 0, 2)] {
                assert_eq!(orient2d(q[i], q[j], q[k]), -sign, "{}: {q:?}", family.name);
            }
        }
    }
}

/// All neighbors of a point within a few units in the last place, against the line y = x: the picture of Kettner et
/// al. that shows where plain f64 errs.
#[test]
fn neighborhood_of_a_line() {
    let (b, c) = (dvec2(12.0, 12.0), dvec2(24.0, 24.0));
    let mut naive_errors = 0;
    for i in 0..128 {
        for j in 0..128 {
            let a = dvec2(0.5 + f64::from(i) * 2.0_f64.powi(-53), 0.5 + f64::from(j) * 2.0_f64.powi(-53));
            // The side of the line y = x is a comparison.
            let expected = match a.y.total_cmp(&a.x) {
                std::cmp::Ordering::Less => Sign::Negative,
                std::cmp::Ordering::Equal => Sign::Zero,
                std::cmp::Ordering::Greater => Sign::Positive,
            };
            assert_eq!(orient2d(b, c, a), expected);
            assert_eq!(orient2d(a, b, c), expected);
            naive_errors += u32::from(naive_orient2d([a, b, c]) != expected);
        }
    }
    assert!(naive_errors > 100);
}

#[test]
fn points_on_a_circle_are_on_it_at_any_scale() {
    let mut random = Random(4);
    let circle = common::pythagorean();
    for _ in 0..2000 {
        let mut q: [DVec2; 4] = std::array::from_fn(|_| {
            let (x, y) = random.pick(&circle);
            dvec2(x as f64, y as f64)
        });
        let shift = dvec2(random.integer(-(1 << 40), 1 << 40) as f64, random.integer(-(1 << 40), 1 << 40) as f64);
        let scale = random.integer(-1074, 980) as i32;
        for p in &mut q {
            *p = (*p + shift).map(|x| common::ldexp(x, scale));
        }
        assert_eq!(incircle(q[0], q[1], q[2], q[3]), Sign::Zero, "{q:?}");
    }
}

#[test]
fn minus_zero_is_zero() {
    let values = [0.0, -0.0, 1.0, -1.0, 5e-324];
    let mut random = Random(5);
    for _ in 0..5000 {
        let q: [DVec2; 4] = std::array::from_fn(|_| dvec2(random.pick(&values), random.pick(&values)));
        let [a, b, c, d] = q.map(|p| p + 0.0);
        assert_eq!(orient2d(q[0], q[1], q[2]), orient2d(a, b, c));
        assert_eq!(incircle(q[0], q[1], q[2], q[3]), incircle(a, b, c, d));
    }
}

#[test]
fn what_is_not_finite_gives_zero_and_no_panic() {
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, 1.0, -3.0, f64::MAX, 5e-324];
    let mut random = Random(6);
    for _ in 0..20_000 {
        let q: [DVec2; 4] = std::array::from_fn(|_| dvec2(random.pick(&values), random.pick(&values)));
        let [a, b, c, d] = q;
        if ![a, b, c].iter().all(|p| p.is_finite()) {
            assert_eq!(orient2d(a, b, c), Sign::Zero, "{q:?}");
        }
        if !q.iter().all(|p| p.is_finite()) {
            assert_eq!(incircle(a, b, c, d), Sign::Zero, "{q:?}");
        }
        polder_predicates::incircle_canonical(a, b, c, d);
        polder_predicates::must_flip(a, b, c, d);
    }
}

fn finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
        4 => (-1000_i32..1000).prop_map(f64::from),
        1 => (-8_i32..8, -1074_i32..900).prop_map(|(m, e)| common::ldexp(f64::from(m), e)),
    ]
}

fn point() -> impl Strategy<Value = DVec2> {
    (finite(), finite()).prop_map(|(x, y)| dvec2(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_finite_points_have_the_exact_signs(q in [point(), point(), point(), point()]) {
        let [a, b, c, d] = q;
        prop_assert_eq!(orient2d(a, b, c), exact_orient2d([a, b, c]));
        prop_assert_eq!(incircle(a, b, c, d), exact_incircle(q));
    }

    #[test]
    fn a_power_of_two_and_a_turn_change_no_sign(
        q in prop::array::uniform4((-500_i32..500, -500_i32..500)),
        exponent in -1074_i32..1010,
    ) {
        let [a, b, c, d] = q.map(|(x, y)| dvec2(f64::from(x), f64::from(y)));
        let signs = (orient2d(a, b, c), incircle(a, b, c, d));
        let [a, b, c, d] = [a, b, c, d].map(|p| p.perp().map(|x| common::ldexp(x, exponent)));
        prop_assert_eq!((orient2d(a, b, c), incircle(a, b, c, d)), signs);
    }
}
