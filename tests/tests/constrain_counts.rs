//! What insertion costs on larger inputs, in flips and rounds; and, for people, in time.
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;

use constrain_support::Start;
use polder_constrain::reference::{self, Insertion};
use polder_io::generate::segments;
use std::time::Instant;

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let out = work();
    println!("{what}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    out
}

/// Where the order of insertion and flips, and the number of inner rounds, were chosen.
#[test]
#[ignore = "long: cargo xtask ci --long"]
fn orders_and_rounds_side_by_side() {
    for (points, constraints) in [(100_000, 10_000), (100_000, 40_000), (1_000_000, 100_000)] {
        println!("\n{points} points, {constraints} constraints");
        let start = timed("stages 1 to 4", || Start::stage_4(&segments(points, constraints, 1)));
        let Start { mesh, positions, constraints, .. } = start;
        let walk = timed("walk", || reference::walk(&mesh, &positions, &constraints).unwrap());
        let crossings = timed("crossings", || reference::crossings(&mesh, &positions, &walk, 1000).unwrap());
        assert!(crossings.pairs.is_empty());

        println!("- constraints, then flips");
        for inner in [1, 2, 3, 5, 8, 12, 20, 1000] {
            let mut mesh = mesh.clone();
            let subs = &walk.sub_constraints;
            let mut insertion = Insertion::new(&mut mesh, &positions, subs).unwrap();
            insertion.set_inner_rounds(inner);
            timed(&format!("{inner} inner rounds"), || {
                while !insertion.is_done() {
                    insertion.outer_round().unwrap();
                }
            });
            println!("    {}, walked {}", insertion.report(), insertion.report().walked);
            if inner == reference::INNER_ROUNDS {
                println!("    {}", timed("flips", || polder_flip::reference::flip(&mut mesh, &positions).unwrap()));
            }
        }
        println!("- flips, then constraints, then flips");
        let mut mesh = mesh.clone();
        println!("    {}", timed("flips", || polder_flip::reference::flip(&mut mesh, &positions).unwrap()));
        let report = timed("insert", || reference::insert(&mut mesh, &positions, &walk.sub_constraints).unwrap());
        println!("    {report}, walked {}", report.walked);
        println!("    {}", timed("flips", || polder_flip::reference::flip(&mut mesh, &positions).unwrap()));
    }
}

/// Constraints side by side into one vertex: the triangles that they cross grow faster in number than they do.
#[test]
#[ignore = "long: cargo xtask ci --long"]
fn the_steps_of_a_fan() {
    for k in [10_000, 40_000] {
        let start = Start::stage_4(&polder_io::generate::fan(k, 1));
        let Start { mut mesh, positions, constraints, .. } = start;
        let walk = timed("walk", || reference::walk(&mesh, &positions, &constraints).unwrap());
        let crossings = timed("crossings", || reference::crossings(&mesh, &positions, &walk, 1000).unwrap());
        assert!(crossings.pairs.is_empty());
        println!("{} {}", walk.sub_constraints.len(), walk.intersections());
        let report = timed("insert", || reference::insert(&mut mesh, &positions, &walk.sub_constraints).unwrap());
        println!("    {report}, walked {}", report.walked);
        println!("    {}", timed("flips", || polder_flip::reference::flip(&mut mesh, &positions).unwrap()));
    }
}
