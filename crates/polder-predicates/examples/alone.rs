//! The predicates alone: plain doubles against exact signs, and a tie that has one answer.
//!
//! `cargo run -p polder-predicates --example alone`

use glam::{DVec2, dvec2};
use polder_predicates::limbs::Span;
use polder_predicates::{Sign, incircle, must_flip, orient2d};

fn main() {
    // On which side of the line through b and c are the points around (0.5, 0.5)? The exact sign changes along the
    // diagonal; plain doubles make a mess of it.
    let (b, c) = (dvec2(12.0, 12.0), dvec2(24.0, 24.0));
    let ulp = 2.0_f64.powi(-53);
    println!("plain f64{:38}exact", "");
    for row in (0..24).rev() {
        let point = |column: u32| dvec2(0.5 + f64::from(column) * ulp, 0.5 + f64::from(row) * ulp);
        let plain: String = (0..40).map(|k| letter((b - point(k)).perp_dot(c - point(k)))).collect();
        let exact: String = (0..40).map(|k| letter(f64::from(orient2d(b, c, point(k)) as i8))).collect();
        println!("{plain}       {exact}");
    }

    // Four corners of a square lie on one circle, also where their squares overflow.
    let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| dvec2(x, y) * 1e300);
    assert_eq!(incircle(a, b, c, d), Sign::Zero);
    println!("\nA square of side 1e300: in a tie, the diagonal at the lexicographically smallest corner stays.");
    println!("flip bc to ad: {}; flip ad to bc: {}", must_flip(a, b, c, d), must_flip(b, d, a, c));

    // What an in-circle test needs when nothing but integers may be used.
    for points in [
        [dvec2(3.0, 4.0), dvec2(-5.0, 0.0), dvec2(0.0, 5.0), dvec2(4.0, 3.0)],
        [dvec2(0.1, 0.7), dvec2(0.9, 0.2), dvec2(0.3, 0.3), dvec2(0.8, 0.6)],
        [dvec2(1e300, 0.0), dvec2(0.0, 1e-300), DVec2::ONE, DVec2::ZERO],
    ] {
        if let Some(span) = Span::of(&points) {
            println!("{:4} bits of coordinates: {:3} limbs", span.bits, span.incircle_limbs());
        }
    }
}

fn letter(value: f64) -> char {
    if value > 0.0 {
        '+'
    } else if value < 0.0 {
        '-'
    } else {
        '0'
    }
}
