//! All constraints walk the same mesh and are cut at the vertices they run through. \[QCT\] section 4.1.
//!
//! 1. Of constraints with the same two ends one walks, from its lower end to its higher one. None of zero length does.
//! 2. The walk leaves the star of its vertex along an edge, whose other end is then the next vertex, or across the edge
//!    opposite the vertex. Then it goes from triangle to triangle; where the corner beyond lies exactly on the line,
//!    that corner is the next vertex. From there it goes on in the same way.
//! 3. Each stretch from vertex to vertex is a piece. Equal pieces of all walks become one sub-constraint.
//!
//! Departures from the paper, which assumes that a constraint meets no vertex between its ends: all of step 3. At a
//! vertex with many edges the way on is found by halving, not by going round.

use super::fan::{Departure, Fans, enter, leave};
use crate::{ConstrainError, Walk};
use glam::DVec2;
use polder_mesh::{Chains, DELETED, GhostMesh};
use polder_predicates::Sign;

/// A stretch of a walk between successive vertices, the lower one first.
#[derive(Clone, Copy)]
struct Piece {
    ends: [u32; 2],
    departure: u32,
    crossed_edges: u32,
}

/// Cuts constraints at the vertices of a triangulation that they run through.
///
/// A constraint is a pair of vertices of the mesh, so duplicate points must have been replaced by the vertices that
/// stand for them. The mesh may be any triangulation of a convex hull, Delaunay or not, and has no constrained edges.
/// Where all points lie on one line, the mesh is their chain; a single vertex needs no mesh.
///
/// The chains are the same in every triangulation of the points; the numbers of crossed edges are not.
///
/// # Errors
///
/// [`ConstrainError::NotAVertex`], [`ConstrainError::MissingPosition`]; [`ConstrainError::TooLarge`] if the chains
/// together have 2³² vertices or more; [`ConstrainError::Lost`] if the mesh is not a triangulation of a convex hull.
pub fn walk(mesh: &GhostMesh, positions: &[DVec2], constraints: &[[u32; 2]]) -> Result<Walk, ConstrainError> {
    super::check_positions(mesh, positions)?;
    let fans = Fans::new(mesh, positions.len());
    for (constraint, &[a, b]) in constraints.iter().enumerate() {
        for vertex in [a, b] {
            let known = if a == b { (vertex as usize) < positions.len() } else { fans.has(vertex) };
            if !known {
                return Err(ConstrainError::NotAVertex { constraint, vertex });
            }
        }
    }

    // Step 1.
    let normal = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut walkers: Vec<[u32; 2]> = constraints.iter().filter(|[a, b]| a != b).map(|&c| normal(c)).collect();
    walkers.sort_unstable();
    walkers.dedup();

    // Step 2.
    let mut pieces: Vec<Piece> = Vec::with_capacity(walkers.len());
    let mut stops: Vec<u32> = Vec::with_capacity(2 * walkers.len());
    let mut stop_offsets: Vec<u32> = Vec::with_capacity(walkers.len() + 1);
    for &ends in &walkers {
        stop_offsets.push(stops.len() as u32);
        walk_one(mesh, positions, &fans, ends, &mut stops, &mut pieces)?;
        if stops.len() > DELETED as usize {
            let constraint = constraints.iter().position(|&c| normal(c) == ends).unwrap_or_default();
            return Err(ConstrainError::TooLarge { constraint, count: stops.len(), limit: DELETED as usize });
        }
    }
    stop_offsets.push(stops.len() as u32);

    // Step 3. Piece i of walker w is at stop_offsets[w] - w + i: a walker has one piece fewer than stops.
    let mut order: Vec<u32> = (0..pieces.len() as u32).collect();
    order.sort_unstable_by_key(|&i| pieces[i as usize].ends);
    let mut walk = Walk { piece_offsets: vec![0], ..Walk::default() };
    let mut id = vec![0u32; pieces.len()];
    for &i in &order {
        let piece = pieces[i as usize];
        if walk.sub_constraints.last() != Some(&piece.ends) {
            walk.sub_constraints.push(piece.ends);
            walk.departures.push(piece.departure);
            walk.crossed_edges.push(piece.crossed_edges);
        }
        id[i as usize] = (walk.sub_constraints.len() - 1) as u32;
    }
    let place = Places::new(&walkers, positions.len());
    walk.chains = Chains::with_capacity(constraints.len());
    let mut count = 0;
    for (constraint, &[a, b]) in constraints.iter().enumerate() {
        let (mut chain, mut along): (&[u32], &[u32]) = (&[a], &[]);
        if a != b {
            let w = place.of(&walkers, normal([a, b]));
            let (from, to) = (stop_offsets[w] as usize, stop_offsets[w + 1] as usize);
            (chain, along) = (&stops[from..to], &id[from - w..to - w - 1]);
        }
        count += chain.len();
        if count > DELETED as usize {
            return Err(ConstrainError::TooLarge { constraint, count, limit: DELETED as usize });
        }
        if a <= b {
            walk.chains.push(chain.iter().copied());
            walk.pieces.extend(along);
        } else {
            walk.chains.push(chain.iter().rev().copied());
            walk.pieces.extend(along.iter().rev());
        }
        walk.piece_offsets.push(walk.pieces.len() as u32);
    }
    Ok(walk)
}

/// Finds a pair of vertices among sorted ones: by its lower vertex, then by halving.
struct Places {
    offsets: Vec<u32>,
}

impl Places {
    fn new(sorted: &[[u32; 2]], vertices: usize) -> Self {
        let mut offsets = vec![0u32; vertices + 1];
        for &[a, _] in sorted {
            offsets[a as usize + 1] += 1;
        }
        for v in 0..vertices {
            offsets[v + 1] += offsets[v];
        }
        Self { offsets }
    }

    fn of(&self, sorted: &[[u32; 2]], pair: [u32; 2]) -> usize {
        let from = self.offsets[pair[0] as usize] as usize;
        let to = self.offsets[pair[0] as usize + 1] as usize;
        from + sorted[from..to].partition_point(|p| p[1] < pair[1])
    }
}

fn walk_one(
    mesh: &GhostMesh,
    positions: &[DVec2],
    fans: &Fans,
    [a, b]: [u32; 2],
    stops: &mut Vec<u32>,
    pieces: &mut Vec<Piece>,
) -> Result<(), ConstrainError> {
    let lost = ConstrainError::Lost { ends: [a, b] };
    let line = [positions[a as usize], positions[b as usize]];
    // Each half-edge is crossed or run along at most once.
    let mut budget = 3 * mesh.slots();
    let mut v = a;
    stops.push(a);
    while v != b {
        let Some(departure) = fans.depart(mesh, positions, v, b) else { return Err(lost) };
        let (w, piece) = match departure {
            Departure::Along(h) => {
                budget = budget.saturating_sub(1);
                let w = mesh.destination(h);
                let h = if v < w { h } else { mesh.twin(h) };
                (w, Piece { ends: [v, w], departure: h, crossed_edges: 0 })
            }
            Departure::Across(first) => {
                let (mut h, mut crossed_edges) = (first, 0);
                loop {
                    if budget == 0 {
                        return Err(lost);
                    }
                    budget -= 1;
                    crossed_edges += 1;
                    let Some((g, side)) = enter(mesh, positions, h, line) else { return Err(lost) };
                    if side == Sign::Zero {
                        let w = mesh.apex(g);
                        // Seen from the other end, the last edge crossed is the first.
                        break (w, Piece { ends: [v, w], departure: if v < w { first } else { g }, crossed_edges });
                    }
                    h = leave(g, side);
                }
            }
        };
        if budget == 0 {
            return Err(lost);
        }
        pieces.push(Piece { ends: [v.min(w), v.max(w)], ..piece });
        stops.push(w);
        v = w;
    }
    Ok(())
}
