//! Step 2: triangles that are there twice, edges with too many triangles, vertices with more than one fan.

use super::mesh::{Mesh, Out};
use super::verdict::{Found, Kind, Place};
use polder_mesh::next;
use rayon::prelude::*;

/// Reports triangles with the same three corners as a lower one, and takes them out of the mesh.
///
/// Two such triangles share every half-edge, so they meet in the list of the smallest corner, side by side if that
/// list is sorted by the other two corners.
pub(super) fn drop_repeated(mesh: &mut Mesh<'_>, found: &mut Found) {
    let look = |v: u32| {
        let others = |out: &Out| (out.destination, mesh.apex(out.half_edge));
        let smallest = |out: &Out| v < out.destination && v < mesh.apex(out.half_edge);
        let crowded = mesh.outgoing(v).zip(mesh.outgoing(v).skip(1)).any(|(a, b)| a.destination == b.destination);
        let mut list: Vec<_> = if crowded { mesh.outgoing(v).filter(smallest).collect() } else { Vec::new() };
        list.sort_by_key(|out| (others(out), out.half_edge));
        let mut repeated = Vec::new();
        for group in list.chunk_by(|a, b| others(a) == others(b)) {
            let triangles = group.iter().map(|out| out.half_edge / 3);
            repeated.extend(triangles.skip(1).map(|t| [group[0].half_edge / 3, t]));
        }
        repeated
    };
    let mut repeated: Vec<[u32; 2]> = (0..mesh.vertices() as u32).into_par_iter().flat_map_iter(look).collect();
    if repeated.is_empty() {
        return;
    }
    repeated.sort_unstable_by_key(|pair| pair[1]);
    repeated.iter().for_each(|&pair| found.add(Kind::RepeatedTriangle, Place::Triangles(pair)));
    mesh.remove(&repeated.iter().map(|pair| pair[1]).collect::<Vec<_>>());
}

/// How the triangles lie around a vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Star {
    /// All around it, in one turn (or there are none).
    Closed,
    /// In one fan, from one boundary edge to another.
    Open,
    /// In several fans.
    Pinched,
    /// Some edge out of it has more than one triangle on its left.
    Crowded,
}

/// Each half-edge has one triangle and each vertex one fan.
pub(super) fn check(mesh: &Mesh<'_>, found: &mut Found) -> Vec<Star> {
    let stars: Vec<_> = (0..mesh.vertices() as u32).into_par_iter().map(|v| star(mesh, v)).collect();
    for (v, star) in stars.iter().enumerate().filter(|(_, star)| !matches!(star, Star::Closed | Star::Open)) {
        let v = v as u32;
        if *star == Star::Pinched {
            found.add(Kind::PinchedVertex, Place::Point(v));
        }
        for (before, out) in mesh.outgoing(v).zip(mesh.outgoing(v).skip(1)) {
            if before.destination == out.destination {
                found.add(Kind::CrowdedEdge, Place::Edge { ends: [v, out.destination], triangle: out.half_edge / 3 });
            }
        }
    }
    stars
}

/// Counts the triangles around a vertex counterclockwise from one of them and, if that ends at a boundary, clockwise
/// too.
fn star(mesh: &Mesh<'_>, v: u32) -> Star {
    let degree = mesh.degree(v);
    let Some(first) = mesh.outgoing(v).next().map(|out| out.half_edge) else { return Star::Closed };
    if mesh.outgoing(v).zip(mesh.outgoing(v).skip(1)).any(|(a, b)| a.destination == b.destination) {
        return Star::Crowded;
    }
    let is_all = |met, whole| if met == degree { whole } else { Star::Pinched };
    let mut met = 1;
    let mut h = first;
    while met <= degree {
        match mesh.find(v, mesh.apex(h)) {
            Some(other) if other == first => return is_all(met, Star::Closed),
            Some(other) => h = other,
            None => break,
        }
        met += 1;
    }
    h = first;
    while met <= degree {
        match mesh.twin(h) {
            Some(other) => h = next(other),
            None => break,
        }
        met += 1;
    }
    is_all(met, Star::Open)
}
