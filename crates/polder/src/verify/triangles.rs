//! Step 1: each triangle by itself.

use super::verdict::{Found, Kind, Place};
use glam::DVec2;
use polder_mesh::NONE;
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;
use std::borrow::Cow;

/// What a triangle is by itself, with its corners named by representatives.
enum Shape {
    OutOfRange,
    Repeated,
    Turns(Sign, [u32; 3]),
}

fn shape(points: &[DVec2], representatives: &[u32], triangle: [u32; 3]) -> Shape {
    if triangle.iter().any(|&corner| corner as usize >= points.len()) {
        return Shape::OutOfRange;
    }
    let corners = triangle.map(|corner| representatives[corner as usize]);
    let [a, b, c] = corners;
    if a == b || b == c || c == a {
        return Shape::Repeated;
    }
    let [a, b, c] = corners.map(|v| points[v as usize]);
    Shape::Turns(orient2d(a, b, c), corners)
}

/// Checks range, corners and orientation. The triangles that come back name representatives, clockwise ones are turned
/// over, and those that cannot be used are [`NONE`] three times.
pub(super) fn check<'a>(
    points: &[DVec2],
    representatives: &[u32],
    triangles: &'a [[u32; 3]],
    found: &mut Found,
) -> Cow<'a, [[u32; 3]]> {
    let mut mine = Found::default();
    mine.sweep(triangles.len(), |range, found| {
        for t in range {
            let place = Place::Triangle(t as u32);
            match shape(points, representatives, triangles[t]) {
                Shape::OutOfRange => found.add(Kind::OutOfRange, place),
                Shape::Repeated => found.add(Kind::RepeatedCorner, place),
                Shape::Turns(Sign::Zero, _) => found.add(Kind::Flat, place),
                Shape::Turns(Sign::Negative, _) => found.add(Kind::Clockwise, place),
                Shape::Turns(Sign::Positive, corners) if corners != triangles[t] => found.renamed = true,
                Shape::Turns(Sign::Positive, _) => {}
            }
        }
    });
    let bad = [Kind::OutOfRange, Kind::RepeatedCorner, Kind::Flat].map(|kind| mine.total(kind)).iter().sum::<u64>();
    let clockwise = mine.total(Kind::Clockwise);
    let as_given = bad + clockwise == 0 && !mine.renamed;
    if clockwise > 0 && bad + clockwise == triangles.len() as u64 {
        mine.forget(Kind::Clockwise);
        found.add(Kind::WhollyClockwise, Place::Mesh);
    }
    found.append(mine);
    if as_given {
        return Cow::Borrowed(triangles);
    }
    let sound = |&triangle: &[u32; 3]| match shape(points, representatives, triangle) {
        Shape::OutOfRange | Shape::Repeated => [NONE; 3],
        Shape::Turns(Sign::Negative, [a, b, c]) => [a, c, b],
        Shape::Turns(_, corners) => corners,
    };
    Cow::Owned(triangles.par_iter().map(sound).collect())
}
