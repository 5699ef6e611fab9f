//! The stage in plain Rust. \[QCT\] section 3.5, with hull flips.
//!
//! A *round*:
//!
//! 1. Each active edge is tested once ([`is_illegal`]).
//! 2. Each illegal edge claims its two triangles; the least [`priority`] of its lower half-edge gets them.
//! 3. Each edge that got both its triangles is flipped, always by its lower half-edge.
//! 4. Active in the next round are the edges around the flips, and the illegal edges next to no flip.
//!
//! The edge with the least priority of all always gets both triangles, so a round without a flip is the last one.
//!
//! Departures from the paper:
//!
//! - The paper remembers verified triangles and tests again all three edges of a new one. Here verified *edges* are
//!   remembered, so that the new diagonal, which is legal by construction, is not tested.
//! - The paper lets the lowest triangle number win. Here a hash of the edge's number decides: in a long row of
//!   conflicts the lowest number would win one flip a round.
//! - The paper closes the hull by triangles to a fake boundary. Here a ghost vertex stands for the outside, and a
//!   ghost edge is illegal where the hull turns strictly reflex: flipping it adds the missing finite triangle.
//! - Signs are exact and ties are settled, so no edge is left for another device to decide.

mod active;
pub mod kernels;
mod signs;
mod start;

pub use active::Active;
pub use signs::{must_flip_signs, orient2d_signs};
pub use start::{chain, sweep};

use crate::{FlipError, FlipReport, priority};
use active::Scope;
use glam::DVec2;
use polder_mesh::{Cancelled, DELETED, GHOST, GhostMesh, NONE, next, prev};
use polder_predicates::{Sign, must_flip, orient2d};

/// Whether the edge of half-edge `h` must be flipped.
///
/// - An edge between two finite triangles: by [`must_flip`].
/// - A ghost edge (one end is the ghost vertex): if the hull is strictly reflex at its finite end.
/// - A hull edge, a constrained edge, and an edge whose two opposite corners are one vertex: never.
pub fn is_illegal(mesh: &GhostMesh, positions: &[DVec2], h: u32) -> bool {
    let g = mesh.twin(h);
    if g == NONE || mesh.is_constrained(h) {
        return false;
    }
    let (a, b, c, d) = (mesh.apex(h), mesh.origin(h), mesh.destination(h), mesh.apex(g));
    if a == d || a == GHOST || d == GHOST {
        return false;
    }
    let at = |v: u32| positions[v as usize];
    if c == GHOST {
        // h runs from v to the ghost, in the ghost triangle of the hull edge from v to a; the one before it is d to v.
        orient2d(at(d), at(b), at(a)) == Sign::Negative
    } else if b == GHOST {
        orient2d(at(a), at(c), at(d)) == Sign::Negative
    } else {
        must_flip(at(a), at(b), at(c), at(d))
    }
}

/// Makes exactly one round and returns the number of flips; `active` then holds the edges of the next round.
pub fn flip_round(mesh: &mut GhostMesh, positions: &[DVec2], active: &mut Active) -> u64 {
    active.fit(mesh);
    // Steps 1 and 2.
    let mut candidates = std::mem::take(&mut active.candidates);
    candidates.retain_mut(|h| {
        if mesh.is_deleted((*h / 3) as usize) {
            return false;
        }
        *h = (*h).min(mesh.twin(*h));
        if std::mem::replace(&mut active.listed[*h as usize], true) {
            return false;
        }
        if active.scope == Scope::Hull && !is_ghost_edge(mesh, *h) {
            active.listed[*h as usize] = false;
            return false;
        }
        active.tests += 1;
        let illegal = is_illegal(mesh, positions, *h);
        if illegal {
            for t in [*h / 3, mesh.twin(*h) / 3] {
                let claim = &mut active.claims[t as usize];
                *claim = (*claim).min(priority(*h));
            }
        } else {
            active.legal.push(*h);
        }
        illegal
    });
    active.illegal = candidates.len() as u64;

    // Step 3.
    let mut flips = 0;
    let winners = &mut active.winners;
    winners.clear();
    for &h in &candidates {
        let pair = [h / 3, mesh.twin(h) / 3];
        if pair.iter().all(|&t| active.claims[t as usize] == priority(h)) {
            winners.push(h);
        }
    }
    for &h in winners.iter() {
        for t in [h / 3, mesh.twin(h) / 3] {
            active.flipped[t as usize] = true;
        }
    }

    // Step 4, and the arrays are cleared for the next round.
    active.candidates.clear();
    for h in active.legal.drain(..) {
        active.listed[h as usize] = false;
    }
    for &h in &candidates {
        active.listed[h as usize] = false;
        let pair = [h / 3, mesh.twin(h) / 3];
        if pair.iter().all(|&t| !active.flipped[t as usize]) {
            active.candidates.push(h);
        }
    }
    for &h in &candidates {
        for t in [h / 3, mesh.twin(h) / 3] {
            active.claims[t as usize] = NONE;
        }
    }
    for &h in &active.winners {
        for t in [h / 3, mesh.twin(h) / 3] {
            active.flipped[t as usize] = false;
        }
        let diagonal = mesh.flip(h);
        let other = mesh.twin(diagonal);
        active.candidates.extend([next(diagonal), prev(diagonal), next(other), prev(other)]);
        flips += 1;
    }
    // Each by its lower half-edge: whoever changes the mesh before the next round changes what the names mean.
    for h in &mut active.candidates {
        *h = (*h).min(mesh.twin(*h));
    }
    flips
}

/// Flips until no edge is illegal: to the constrained Delaunay triangulation of a convex hull.
///
/// # Errors
///
/// [`FlipError::MissingPosition`] if a corner has no position. [`FlipError::BoundExceeded`] after [`round_bound`]
/// rounds; a mesh whose finite triangles are counterclockwise and do not overlap is not known to come near it.
pub fn flip(mesh: &mut GhostMesh, positions: &[DVec2]) -> Result<FlipReport, FlipError> {
    flip_with(mesh, positions, &mut || Ok(()))
}

/// The same, asking before each round whether to go on.
///
/// # Errors
///
/// As [`flip`], and [`FlipError::Cancelled`]; the mesh is then a triangulation as before, flipped in part.
pub fn flip_with(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    go_on: &mut dyn FnMut() -> Result<(), Cancelled>,
) -> Result<FlipReport, FlipError> {
    check_positions(mesh, positions)?;
    run(mesh, positions, Active::all(mesh), "flip", go_on)
}

/// Ghost flips alone, until the hull is nowhere strictly reflex.
///
/// Each flip takes one edge off the hull, so there are fewer flips than ghost triangles. The mesh stays a
/// triangulation where the new triangles do not overlap others, which is the caller's to know: it holds for instance
/// if the hull is star-shaped, or made of two chains that are monotone in the same direction.
///
/// # Errors
///
/// As [`flip`].
pub fn close_hull(mesh: &mut GhostMesh, positions: &[DVec2]) -> Result<FlipReport, FlipError> {
    check_positions(mesh, positions)?;
    run(mesh, positions, Active::hull(mesh), "close hull", &mut || Ok(()))
}

/// The number of rounds after which [`flip`] gives up, for a mesh of so many triangles.
///
/// Lawson's flips never bring back an edge, so they end; how many rounds they need at worst is not known. Random points
/// need a few dozen, and the worst families in the tests fewer than one round a triangle. The bound leaves room for
/// sixteen.
pub fn round_bound(triangles: usize) -> u64 {
    64 + 16 * triangles as u64
}

fn run(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    mut active: Active,
    stage: &'static str,
    go_on: &mut dyn FnMut() -> Result<(), Cancelled>,
) -> Result<FlipReport, FlipError> {
    let mut report = FlipReport::default();
    let bound = round_bound(mesh.slots());
    while !active.is_empty() {
        go_on()?;
        if report.rounds == bound {
            return Err(FlipError::BoundExceeded { stage, rounds: bound, triangles: mesh.slots() });
        }
        report.rounds += 1;
        report.flips += flip_round(mesh, positions, &mut active);
    }
    report.tests = active.tests();
    Ok(report)
}

pub(crate) fn check_positions(mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), FlipError> {
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v < DELETED && v as usize >= positions.len()) {
            return Err(FlipError::MissingPosition { triangle, vertex, positions: positions.len() });
        }
    }
    Ok(())
}

fn is_ghost_edge(mesh: &GhostMesh, h: u32) -> bool {
    mesh.origin(h) == GHOST || mesh.destination(h) == GHOST
}
