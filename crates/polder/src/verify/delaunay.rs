//! Steps 6 and 7: every unconstrained inner edge is locally Delaunay, ties settled canonically.

use super::constraints::Marks;
use super::mesh::Mesh;
use super::verdict::{Found, Kind, Place};
use polder_predicates::{Sign, incircle, must_flip, orient2d};

pub(super) fn check(mesh: &Mesh<'_>, marks: &Marks, found: &mut Found) {
    let flat = found.total(Kind::Flat) > 0;
    found.sweep(mesh.vertices(), |range, found| {
        for v in range.start as u32..range.end as u32 {
            for out in mesh.outgoing(v).filter(|out| v < out.destination) {
                let h = out.half_edge;
                let Some(twin) = mesh.twin(h).filter(|_| !marks.has(h)) else { continue };
                // The edge runs from b to c with a on its left; d lies on the other side.
                let corners = [mesh.apex(h), v, out.destination, mesh.apex(twin)];
                let [a, b, c, d] = corners.map(|v| mesh.point(v));
                if flat && (orient2d(a, b, c) != Sign::Positive || orient2d(d, c, b) != Sign::Positive) {
                    continue;
                }
                let place = Place::Edge { ends: [v, out.destination], triangle: h / 3 };
                match incircle(a, b, c, d) {
                    Sign::Positive => found.add(Kind::NotDelaunay, place),
                    Sign::Zero if must_flip(a, b, c, d) => found.add(Kind::OtherDiagonal, place),
                    _ => {}
                }
            }
        }
    });
}
