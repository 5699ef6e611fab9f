//! The same input has the same digest, whatever the order of points and constraints, the number of threads, and the
//! backend.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder::{Backend, Options, triangulate};
use polder_mesh::{Pslg, Triangulation};
use polder_tests::{canonical_digest, constrained_families, families, point_families, shuffled};

fn with(pslg: &Pslg, backend: Backend, threads: usize, name: &str) -> Triangulation {
    let mut options = Options::with_backend(backend);
    options.threads = threads;
    triangulate(pslg, &options).unwrap_or_else(|error| panic!("{name}: {error}")).triangulation
}

const SIZES: [usize; 5] = [3, 5, 17, 100, 1000];

#[test]
fn threads_do_not_matter() {
    for n in [17, 20_000] {
        for (name, pslg) in families(n, 1) {
            let one = with(&pslg, Backend::Cpu, 1, name);
            for threads in [2, 5] {
                let more = with(&pslg, Backend::Cpu, threads, name);
                assert_eq!(one.digest(), more.digest(), "{name}, {n} points, {threads} threads");
                assert!(one == more, "{name}, {n} points, {threads} threads: chains or bits differ");
            }
        }
    }
}

#[test]
fn the_order_of_points_and_constraints_does_not_matter() {
    for n in SIZES {
        for (name, pslg) in families(n, 2) {
            let triangulation = with(&pslg, Backend::Cpu, 0, name);
            let digest = canonical_digest(&pslg, triangulation.triangles());
            assert_eq!(digest, triangulation.digest(), "{name}, {n} points: not in canonical order");
            for seed in 0..3 {
                let other = shuffled(&pslg, seed);
                let back = other.digest_back(&with(&other.pslg, Backend::Cpu, 0, name));
                assert_eq!(back, digest, "{name}, {n} points, shuffle {seed}");
            }
        }
    }
}

#[test]
fn the_order_of_a_large_input_does_not_matter() {
    for (name, pslg) in families(20_000, 3) {
        let other = shuffled(&pslg, 4);
        let back = other.digest_back(&with(&other.pslg, Backend::Cpu, 0, name));
        assert_eq!(back, with(&pslg, Backend::Cpu, 0, name).digest(), "{name}");
    }
}

fn same_on_both(name: &str, pslg: &Pslg) {
    let [cpu, reference] = [Backend::Cpu, Backend::Reference].map(|backend| with(pslg, backend, 0, name));
    assert_eq!(cpu.digest(), reference.digest(), "{name}, {} points", pslg.points().len());
    assert!(cpu == reference, "{name}, {} points: chains or bits differ", pslg.points().len());
}

#[test]
fn the_backend_does_not_matter_for_points() {
    for n in SIZES {
        for (name, pslg) in point_families(n, 7) {
            same_on_both(name, &pslg);
        }
    }
}

#[test]
fn the_backend_does_not_matter_with_constraints() {
    for n in SIZES {
        for (name, pslg) in constrained_families(n, 7) {
            same_on_both(name, &pslg);
        }
    }
}

#[test]
fn the_backend_does_not_matter_at_twenty_thousand_points() {
    for (name, pslg) in families(20_000, 8) {
        same_on_both(name, &pslg);
    }
}

#[test]
#[ignore = "long: cargo xtask ci --long"]
fn the_backend_does_not_matter_for_large_inputs() {
    // What the reference takes very long for at that size: a fan needs a round for every few of its constraints, a strip
    // longer than the grid can be needs long rows of flips.
    for (name, pslg) in families(200_000, 9).into_iter().filter(|(name, _)| !["fan", "strip"].contains(name)) {
        same_on_both(name, &pslg);
    }
}

/// The chain of a constraint is the same set of places, wherever its points stand in the input.
#[test]
fn chains_move_along_with_their_points() {
    for (name, pslg) in families(300, 5) {
        let triangulation = with(&pslg, Backend::Cpu, 0, name);
        let other = shuffled(&pslg, 6);
        let moved = with(&other.pslg, Backend::Cpu, 0, name);
        for (new, &old) in other.constraints.iter().enumerate() {
            let mut there: Vec<_> = moved.chains().get(new).iter().map(|&v| other.pslg.points()[v as usize]).collect();
            let here: Vec<_> =
                triangulation.chains().get(old as usize).iter().map(|&v| pslg.points()[v as usize]).collect();
            if here.first() != there.first() {
                there.reverse();
            }
            assert_eq!(here, there, "{name}, constraint {old}");
        }
    }
}
