//! What a caller of the facade may rely on, on every backend that runs on a CPU.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder::{Backend, DVec2, Error, Options, Pslg, triangulate, verify};
use polder_io::generate;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

const BACKENDS: [Backend; 2] = [Backend::Cpu, Backend::Reference];

fn pslg(points: &[(f64, f64)], constraints: &[[u32; 2]]) -> Pslg {
    Pslg::new(points.iter().map(|&(x, y)| DVec2::new(x, y)).collect(), constraints.to_vec()).unwrap()
}

#[test]
fn too_few_points_and_points_on_a_line_give_a_valid_empty_triangulation() {
    let line: Vec<_> = (0..5).map(|i| (f64::from(i) * 0.1, f64::from(i) * 0.1)).collect();
    for (points, constraints, chains) in [
        (vec![], vec![], vec![]),
        (vec![(1.0, 2.0)], vec![[0, 0]], vec![vec![0]]),
        (vec![(1.0, 2.0), (3.0, 4.0)], vec![[1, 0]], vec![vec![1, 0]]),
        (vec![(1.0, 2.0); 7], vec![[2, 5]], vec![vec![0]]),
        (line, vec![[4, 0], [1, 3]], vec![vec![4, 3, 2, 1, 0], vec![1, 2, 3]]),
    ] {
        let input = pslg(&points, &constraints);
        for backend in BACKENDS {
            let output = triangulate(&input, &Options::with_backend(backend)).unwrap();
            assert!(output.triangulation.triangles().is_empty());
            assert_eq!(output.triangulation.representatives().len(), points.len());
            let found: Vec<Vec<u32>> = output.triangulation.chains().iter().map(<[u32]>::to_vec).collect();
            assert_eq!(found, chains, "{backend:?}");
            assert!(verify::check_triangulation(&input, &output.triangulation).is_valid());
        }
    }
}

#[test]
fn every_point_and_constraint_is_accounted_for() {
    let input = pslg(
        &[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (-0.0, 0.0), (2.0, 2.0), (0.0, 4.0)],
        &[[0, 2], [2, 3], [0, 3], [5, 5], [4, 0]],
    );
    for backend in BACKENDS {
        let report = triangulate(&input, &Options::with_backend(backend)).unwrap().report;
        assert_eq!((report.points.total, report.points.vertices, report.points.duplicates), (6, 5, 1));
        assert_eq!(report.constraints.total, 5);
        assert_eq!(report.constraints.zero_length, [2, 3]);
        assert_eq!(report.constraints.repeated, [1]);
        assert_eq!(report.constraints.through_vertices, 2);
        assert_eq!(report.constraints.constrained_edges, 2);
        assert_eq!(report.triangles, 4);
        assert!(!report.why.is_empty() && !report.stages.is_empty());
    }
}

#[test]
fn all_crossings_are_named_the_same_on_every_backend() {
    // A third constraint between two that cross: an insertion would never see the two meet.
    let points = [(0.0, 0.0), (4.0, 4.0), (0.0, 4.0), (4.0, 0.0), (1.5, -1.0), (2.5, 5.0)];
    let input = pslg(&points, &[[0, 1], [2, 3], [4, 5], [1, 0]]);
    let expected = vec![[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]];
    for backend in BACKENDS {
        let error = triangulate(&input, &Options::with_backend(backend)).unwrap_err();
        assert_eq!(error, Error::CrossingConstraints { pairs: expected.clone(), truncated: false });
        assert_eq!(error.kind(), "crossing_constraints");
        assert_eq!(error.to_string(), "5 pairs of constraints cross, the first 0 and 1");
        let few = Options { max_crossings: 2, ..Options::with_backend(backend) };
        let Err(Error::CrossingConstraints { pairs, truncated: true }) = triangulate(&input, &few) else {
            panic!("more crossings than asked for must be flagged");
        };
        assert_eq!(pairs.len(), 2);
    }
}

#[test]
fn a_cancelled_call_says_so() {
    let input = generate::segments(30_000, 3_000, 1);
    for backend in BACKENDS {
        // Before it starts, and from the progress callback, a few steps in.
        for after in [0, 2] {
            let cancel = Arc::new(AtomicBool::new(after == 0));
            let steps = AtomicU64::new(0);
            let flag = cancel.clone();
            let progress = move |_| {
                if steps.fetch_add(1, Ordering::Relaxed) + 1 >= after {
                    flag.store(true, Ordering::Relaxed);
                }
            };
            let options =
                Options { cancel: Some(cancel), progress: Some(Arc::new(progress)), ..Options::with_backend(backend) };
            let error = triangulate(&input, &options).unwrap_err();
            assert_eq!(error.kind(), "cancelled", "{backend:?} after {after}");
        }
    }
}

/// Stages of many rounds stop between two of them.
#[test]
fn references_stop_between_rounds() {
    let sparse = generate::segments(3000, 300, 1);
    let delaunay = triangulate(&sparse, &Options::default()).unwrap().triangulation;
    let edges = delaunay.edges().map(|edge| edge.vertices.map(|v| v.0)).take(2500).collect();
    let outlines = Pslg::new(sparse.points().to_vec(), edges).unwrap();
    for stage in ["shift", "insert", "flip_points", "constrain", "flip"] {
        let input = if stage == "flip_points" { &outlines } else { &sparse };
        for rounds in [2, 3] {
            let cancel = Arc::new(AtomicBool::new(false));
            let (flag, steps, last) = (cancel.clone(), AtomicU64::new(0), Arc::new(Mutex::new("")));
            let told = last.clone();
            let progress = move |p: polder::Progress| {
                *told.lock().unwrap() = p.stage;
                if p.stage == stage && steps.fetch_add(1, Ordering::Relaxed) + 1 == rounds {
                    flag.store(true, Ordering::Relaxed);
                }
            };
            let options = Options {
                cancel: Some(cancel),
                progress: Some(Arc::new(progress)),
                ..Options::with_backend(Backend::Reference)
            };
            assert_eq!(triangulate(input, &options).unwrap_err().kind(), "cancelled", "{stage}");
            assert_eq!(*last.lock().unwrap(), stage);
        }
    }
}

#[test]
fn progress_names_the_stages() {
    let input = generate::segments(30_000, 3_000, 1);
    for (backend, expected) in BACKENDS.into_iter().zip([
        &["order", "delaunay", "constrain"][..],
        &["voronoi", "dualize", "shift", "insert", "constrain", "flip", "canonical_order"][..],
    ]) {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let sink = seen.clone();
        let progress = move |p: polder::Progress| {
            assert!(p.done <= p.total);
            sink.lock().unwrap().push(p.stage);
        };
        let options = Options { progress: Some(Arc::new(progress)), ..Options::with_backend(backend) };
        triangulate(&input, &options).unwrap();
        let mut stages = seen.lock().unwrap().clone();
        stages.dedup();
        assert_eq!(stages, expected);
    }
}

#[test]
fn threads_do_not_change_the_result() {
    let input = generate::segments(50_000, 5_000, 7);
    let one = triangulate(&input, &Options { threads: 1, ..Options::default() }).unwrap().triangulation;
    for threads in [2, 3, 8] {
        let more = triangulate(&input, &Options { threads, ..Options::default() }).unwrap();
        assert_eq!(more.report.threads, threads);
        assert_eq!(more.triangulation, one);
        assert_eq!(more.triangulation.neighbors(), one.neighbors());
    }
}

#[test]
fn what_cannot_be_had_is_unsupported() {
    let input = generate::uniform(10, 1);
    // Also on a machine that has a GPU.
    let device = polder::vulkan::Selection::Name("no such device".into());
    let vulkan = Options { device, ..Options::with_backend(Backend::Vulkan) };
    assert_eq!(triangulate(&input, &vulkan).unwrap_err().kind(), "unsupported");
    let threads = Options { threads: 100_000, ..Options::default() };
    assert_eq!(triangulate(&input, &threads).unwrap_err().kind(), "unsupported");
    for side in [0, u32::MAX] {
        let grid = Options { grid: Some(side), ..Options::with_backend(Backend::Reference) };
        assert_eq!(triangulate(&input, &grid).unwrap_err().kind(), "unsupported");
    }
}

#[test]
fn the_grid_does_not_change_the_result() {
    let input = generate::segments(3_000, 300, 3);
    let expected = triangulate(&input, &Options::default()).unwrap().triangulation;
    for side in [1, 2, 17, 100, 1000] {
        let options = Options { grid: Some(side), ..Options::with_backend(Backend::Reference) };
        assert_eq!(triangulate(&input, &options).unwrap().triangulation, expected, "grid {side}");
    }
}
