//! Stage 3: sites move from their pixel centers to their true positions. [QCT] section 3.3.
//!
//! 1. *Pin.* Move all sites. Pin the corners of every finite triangle that is then not strictly counterclockwise: a
//!    pinned site stands at its pixel center again. Repeat, testing the triangles around newly pinned sites, until all
//!    are counterclockwise.
//! 2. *Unpin.* Each pinned site is tried once more at its true position, all others staying where they are; it is freed
//!    if the finite triangles around it stay counterclockwise. A site is tried in the round in which it has the least
//!    priority among the pinned sites around it that have not been tried.
//! 3. *Close.* Ghost flips until the hull is convex. The dual's is reflex where the sides of the grid made it so, and
//!    moving the sites bends any.
//! 4. *Take out* the sites that are still pinned; see the module `takeout`.
//! 5. Check the certificate.
//!
//! # Why the triangles stay a triangulation
//!
//! Step 1 ends, since each round pins a site or is the last, and with all sites pinned nothing has moved.
//!
//! Let a *mixed position* be a choice, for each site, of its true position or its pixel center. The mapping to the grid
//! is an exact floor, so two sites in different columns have the same strict order of x coordinates in every mixed
//! position, and likewise rows and y. Consider an edge between two sites: between the pixel centers it has the vector
//! `(p, q)`, in a mixed position `(x, y)`. If `p` is not zero then `x` has the sign of `p`; if `q` is not zero then `y`
//! has the sign of `q`; and one of the two is not zero. So `p x + q y > 0`: every edge turns by less than a right
//! angle.
//!
//! Now take a mixed position in which every finite triangle is counterclockwise, as after steps 1 and 2. Let `a` in
//! (0, π) be an angle of a triangle before, `b` in (0, π) the same angle after, and `s`, `t` in (-π/2, π/2) the turns of
//! its two sides. Then `b = a + t - s` up to a multiple of 2π. But `a + t - s` lies strictly between -π and 2π, and the
//! only number in (0, π) that differs from one there by a multiple of 2π is itself. So `b = a + t - s`, and around a
//! vertex the turns cancel: the angles around an inner vertex still sum to 2π, those at a hull vertex change by the
//! turns of its two hull edges alone and stay below 2π. By the count in the module `certify` the hull turns by 2π in
//! all.
//!
//! Closing the hull keeps that. A ghost flip at a strictly reflex vertex fills in its outer angle exactly, so the vertex
//! becomes an inner one with angle 2π. What could go wrong is that the new triangle's angle is larger than the room
//! outside one of its other two vertices. The hull before the move has four parts, lower, right, upper and left, that are
//! strictly monotone in their direction, and overlap or have a vertex in common: that of the dual has, along the sides of
//! the grid (see the module `dualize`), and so has a convex one. Monotone parts are so in mixed positions as well. Inside
//! a part the new triangle has room, because there the next vertex lies beyond it, and the part that remains is
//! monotone. Where two parts meet, say the left one, which comes from above, and the lower one, which goes on to the
//! right, the angle inside is that from the way on to the way back, between -π/2 and 3π/2. It is reflex only if the hull
//! comes from the upper left and goes on to the lower right; the edge that the flip puts there goes right and down, so
//! the two parts then overlap in it. The certificate checks the end of it.
//!
//! If all sites lie on one line of the grid there is no finite triangle to pin for. The chain is strictly monotone, so
//! its two sides are closed as above; it stays a chain if the true positions are on one line as well.
//!
//! Departures: [QCT] moves one site after the other wherever its neighbors with lower numbers are done, which takes
//! many rounds and gets in the way of more sites than it must.

use super::certify::certify;
use super::star::star;
use super::takeout::take_out;
use crate::{DualizeError, Shifted};
use glam::DVec2;
use polder_flip::priority;
use polder_flip::reference::close_hull;
use polder_mesh::{Cancelled, GHOST, GhostMesh, NONE};
use polder_predicates::{Sign, orient2d};

/// Moves the sites of a dualized mesh from `centers` to `positions` and takes out those that cannot move.
///
/// `centers` holds the center of each site's pixel, `positions` the true position of each site, and of further points
/// perhaps; both by site number. Points and centers in different columns, or rows, of pixels must be strictly ordered
/// as these are: [`GridMapping`](polder_voronoi::GridMapping) guarantees it.
///
/// # Errors
///
/// [`DualizeError::Mismatch`] if there are fewer positions than centers or a corner of the mesh has none. Every other
/// error means that the mesh was not a triangulation of the centers, or the order above was not kept.
pub fn shift(mesh: GhostMesh, centers: &[DVec2], positions: &[DVec2]) -> Result<Shifted, DualizeError> {
    shift_with(mesh, centers, positions, &mut || Ok(()))
}

/// The same, asking before each step, and before each round of taking out, whether to go on.
///
/// # Errors
///
/// As [`shift`], and [`DualizeError::Cancelled`].
pub fn shift_with(
    mesh: GhostMesh,
    centers: &[DVec2],
    positions: &[DVec2],
    go_on: &mut dyn FnMut() -> Result<(), Cancelled>,
) -> Result<Shifted, DualizeError> {
    let sites = centers.len();
    if positions.len() < sites {
        return Err(DualizeError::Mismatch { what: "a site without a position", index: positions.len() });
    }
    let corners = mesh.triangles.as_flattened();
    if let Some(index) = corners.iter().position(|&v| v != GHOST && v as usize >= sites) {
        return Err(DualizeError::Mismatch { what: "a corner that is no site", index: index / 3 });
    }
    let mut mesh = mesh;
    let mut at = positions[..sites].to_vec();
    let mut pinned = vec![false; sites];
    let pin_rounds = pin(&mesh, centers, &mut at, &mut pinned)?;
    let bad = pinned.iter().filter(|&&p| p).count();
    go_on()?;
    let unpin_rounds = unpin(&mesh, centers, positions, &mut at, &mut pinned)?;
    let stuck = pinned.iter().filter(|&&p| p).count();
    go_on()?;
    let hull = close_hull(&mut mesh, &at)?;
    certify(&mesh, &at, "shift")?;
    let taken = take_out(&mut mesh, &at, pinned, go_on)?;
    certify(&mesh, &positions[..sites], "take out")?;
    let rounds = [pin_rounds, unpin_rounds, taken.rounds];
    Ok(Shifted { mesh, heirs: taken.heirs, freed: taken.freed, bad, stuck, rounds, hull })
}

/// Step 1. Returns the number of rounds.
fn pin(mesh: &GhostMesh, centers: &[DVec2], at: &mut [DVec2], pinned: &mut [bool]) -> Result<u64, DualizeError> {
    // Whether a site has moved in the last round: triangles without such a corner are as they were.
    let mut fresh = vec![true; at.len()];
    let mut to_pin = vec![false; at.len()];
    for round in 1..=at.len() as u64 + 1 {
        for t in mesh.finite() {
            let corners = mesh.triangles[t].map(|v| v as usize);
            if corners.iter().any(|&v| fresh[v]) {
                let [a, b, c] = corners.map(|v| at[v]);
                if orient2d(a, b, c) != Sign::Positive {
                    corners.iter().for_each(|&v| to_pin[v] = true);
                }
            }
        }
        fresh.fill(false);
        let mut any = false;
        for v in 0..at.len() {
            if std::mem::take(&mut to_pin[v]) && !pinned[v] {
                (pinned[v], fresh[v], at[v]) = (true, true, centers[v]);
                any = true;
            }
        }
        if !any {
            return Ok(round);
        }
    }
    Err(DualizeError::BoundExceeded { stage: "pin", bound: at.len() as u64 + 1 })
}

/// Step 2. Returns the number of rounds.
fn unpin(
    mesh: &GhostMesh,
    centers: &[DVec2],
    positions: &[DVec2],
    at: &mut [DVec2],
    pinned: &mut [bool],
) -> Result<u64, DualizeError> {
    let half_edge = mesh.half_edge_of_vertex(at.len());
    let mut waiting = pinned.to_vec();
    let mut todo: Vec<u32> = (0..at.len() as u32).filter(|&v| pinned[v as usize]).collect();
    let bound = todo.len() as u64;
    let mut rounds = 0;
    while !todo.is_empty() {
        if rounds == bound {
            return Err(DualizeError::BoundExceeded { stage: "unpin", bound });
        }
        rounds += 1;
        let least = |v: u32| {
            star(mesh, half_edge[v as usize])
                .map(|h| mesh.destination(h))
                .all(|u| u == GHOST || !waiting[u as usize] || priority(u) > priority(v))
        };
        let (turn, later): (Vec<u32>, Vec<u32>) = todo.into_iter().partition(|&v| least(v));
        for &v in &turn {
            at[v as usize] = positions[v as usize];
            if star_is_counterclockwise(mesh, half_edge[v as usize], at) {
                pinned[v as usize] = false;
            } else {
                at[v as usize] = centers[v as usize];
            }
            waiting[v as usize] = false;
        }
        todo = later;
    }
    Ok(rounds)
}

fn star_is_counterclockwise(mesh: &GhostMesh, start: u32, at: &[DVec2]) -> bool {
    start != NONE
        && star(mesh, start).map(|h| (h / 3) as usize).filter(|&t| mesh.is_finite(t)).all(|t| {
            let [a, b, c] = mesh.triangles[t].map(|v| at[v as usize]);
            orient2d(a, b, c) == Sign::Positive
        })
}
