//! What a triangulation of ours holds beside its triangles.

use super::Inspected;
use super::points::compare;
use super::verdict::{Found, Kind, Place};
use polder_mesh::{NONE, Pslg, Triangulation};
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;

pub(super) fn check(pslg: &Pslg, triangulation: &Triangulation, inspected: &Inspected<'_>, found: &mut Found) {
    check_representatives(triangulation, inspected, found);
    check_edges(triangulation, inspected, found);
    check_chains(pslg, triangulation, inspected, found);
}

fn check_representatives(triangulation: &Triangulation, inspected: &Inspected<'_>, found: &mut Found) {
    let (given, true_ones) = (triangulation.representatives(), &inspected.representatives);
    found.sweep(given.len().max(true_ones.len()), |range, found| {
        for v in range {
            if given.get(v) != true_ones.get(v) {
                found.add(Kind::WrongRepresentative, Place::Point(v as u32));
            }
        }
    });
}

/// Neighbors and constrained bits. Where the triangles are not sound as given, they are compared with what was made of
/// them, and there are other problems anyhow.
fn check_edges(triangulation: &Triangulation, inspected: &Inspected<'_>, found: &mut Found) {
    let Inspected { mesh, marks, .. } = inspected;
    let (neighbors, bits) = (triangulation.neighbors(), triangulation.constrained_bits());
    found.sweep(mesh.triangles.len(), |range, found| {
        for t in range.filter(|&t| mesh.triangles[t][0] != NONE) {
            for k in 0..3 {
                let h = (3 * t + k) as u32;
                let place = Place::Edge { ends: [mesh.origin(h), mesh.destination(h)], triangle: t as u32 };
                let neighbor = mesh.twin(h).map_or(NONE, |other| other / 3);
                if neighbors.get(t).map(|all| all[k]) != Some(neighbor) {
                    found.add(Kind::WrongNeighbor, place);
                }
                if bits.get(t).map(|all| all >> k & 1 == 1) != Some(marks.has(h)) {
                    found.add(Kind::WrongConstrainedBit, place);
                }
            }
        }
    });
}

/// Each chain runs from end to end, strictly forward and exactly on the segment, and misses no vertex on it: where
/// there are triangles, since its pieces are mesh edges; where all points lie on one line, since its vertices follow
/// each other in the order on that line.
fn check_chains(pslg: &Pslg, triangulation: &Triangulation, inspected: &Inspected<'_>, found: &mut Found) {
    let (mesh, chains, representatives) = (&inspected.mesh, triangulation.chains(), &inspected.representatives);
    let rank = if mesh.triangles.is_empty() { ranks(pslg, representatives) } else { Vec::new() };
    let right = |i: usize| {
        let ends = pslg.constraints()[i].map(|end| representatives[end as usize]);
        let chain = chains.get(i);
        let is_vertex = |&v: &u32| representatives.get(v as usize) == Some(&v);
        if chain.first() != Some(&ends[0]) || chain.last() != Some(&ends[1]) || !chain.iter().all(is_vertex) {
            return false;
        }
        let [a, b] = ends.map(|v| mesh.point(v));
        let forward = compare(a, b);
        chain.windows(2).all(|pair| {
            let [p, q] = [pair[0], pair[1]].map(|v| mesh.point(v));
            let is_piece = if rank.is_empty() {
                mesh.find(pair[0], pair[1]).or(mesh.find(pair[1], pair[0])).is_some()
            } else {
                rank[pair[0] as usize].abs_diff(rank[pair[1] as usize]) == 1
            };
            is_piece && compare(p, q) == forward && orient2d(a, b, q) == Sign::Zero
        })
    };
    let constraints = pslg.constraints().len();
    if chains.len() != constraints {
        found.add(Kind::WrongChain, Place::Mesh);
        return;
    }
    found.sweep(constraints, |range, found| {
        for i in range.filter(|&i| !right(i)) {
            let vertex = representatives[pslg.constraints()[i][0] as usize];
            found.add(Kind::WrongChain, Place::Constraint { constraint: i as u32, vertex });
        }
    });
}

/// The place of each vertex in lexicographic order.
fn ranks(pslg: &Pslg, representatives: &[u32]) -> Vec<u32> {
    let mut sorted: Vec<u32> =
        (0..representatives.len() as u32).filter(|&v| representatives[v as usize] == v).collect();
    sorted.par_sort_unstable_by(|&v, &w| compare(pslg.points()[v as usize], pslg.points()[w as usize]));
    let mut rank = vec![NONE; representatives.len()];
    sorted.iter().enumerate().for_each(|(i, &v)| rank[v as usize] = i as u32);
    rank
}
