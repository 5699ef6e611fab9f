//! Finding a point in a triangulation, by a straight walk. [QCT] section 3.4 asks for the container alone.
//!
//! The walk follows the segment from a vertex, its start, to the point:
//!
//! 1. At a vertex: turn around it, towards the side on which the point lies, until the segment leads along an edge or
//!    into a triangle. Where a ghost triangle comes first the point is outside.
//! 2. Along an edge: the point is one of its ends, lies between them, or beyond the far end, which is then the start.
//! 3. Into a triangle: the segment leaves it by the edge across. If the point is not beyond that edge, it is inside or
//!    on the edge. If it is, the walk enters the next triangle, where the new corner decides between the other two
//!    edges; if the segment leads through the corner, go on as along an edge.
//!
//! A walk that starts from a ghost triangle first asks whether the point lies outside its hull edge: then that is all.
//!
//! It is exact: a segment through vertices and along edges is followed through them. It ends, because each triangle
//! and edge is met in the order of the segment and none of them twice. A walk that goes to any neighbor on whose side
//! the point lies can go round in circles in a triangulation that is not Delaunay.

use crate::DualizeError;
use glam::DVec2;
use polder_mesh::{GHOST, GhostMesh, next, prev};
use polder_predicates::{Sign, orient2d};

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// On a vertex.
    Vertex(u32),
    /// Strictly inside a finite triangle.
    Inside(u32),
    /// Strictly between the ends of the edge of this half-edge.
    Edge(u32),
    /// Strictly outside the hull; the hull edge of this ghost triangle is one that the walk saw it beyond.
    Outside(u32),
}

/// What one turn or step leads to.
enum Step {
    Found(Place),
    /// The point lies strictly in the angle of this half-edge's triangle at its origin.
    Into(u32),
    /// The point lies on the ray along this half-edge.
    Along(u32),
    /// The segment goes through the origin of this half-edge.
    Through(u32),
}

pub(super) struct Walk<'a> {
    pub(super) mesh: &'a GhostMesh,
    pub(super) positions: &'a [DVec2],
    /// Predicates evaluated and edges turned past, by all walks so far.
    pub(super) steps: u64,
}

impl Walk<'_> {
    /// Finds the place of point `i`; the walk starts at a vertex of the triangle of half-edge `from`.
    ///
    /// The mesh must have a finite triangle, and its hull be convex.
    pub(super) fn locate(&mut self, i: u32, from: u32) -> Result<Place, DualizeError> {
        let mesh = self.mesh;
        let p = self.at(i);
        let limit = self.steps + 12 * mesh.slots() as u64 + 16;
        // Who was outside before mostly still is, and turning around a vertex of the hull can take long.
        if let Some(k) = mesh.triangles[(from / 3) as usize].iter().position(|&v| v == GHOST) {
            let hull = from - from % 3 + k as u32;
            if self.side(mesh.origin(hull), mesh.destination(hull), p) == Sign::Positive {
                return Ok(Place::Outside(from / 3));
            }
        }
        let mut h = if mesh.origin(from) == GHOST { next(from) } else { from };
        loop {
            if p == self.at(mesh.origin(h)) {
                return Ok(Place::Vertex(mesh.origin(h)));
            }
            // To a half-edge whose triangle is finite: at a hull vertex two steps on at most.
            for _ in 0..2 {
                if mesh.is_ghost((h / 3) as usize) {
                    h = mesh.rotate_ccw(h);
                }
            }
            let mut step = self.turn(p, h, limit);
            if let Some(Step::Into(g)) = step {
                step = self.cross(p, g, limit);
            }
            match step {
                Some(Step::Found(place)) => return Ok(place),
                Some(Step::Along(g)) => match self.along(p, g) {
                    Some(place) => return Ok(place),
                    None => h = mesh.twin(g),
                },
                Some(Step::Through(g)) => h = g,
                _ => return Err(DualizeError::WalkLost { point: i, steps: self.steps }),
            }
        }
    }

    fn at(&self, v: u32) -> DVec2 {
        self.positions[v as usize]
    }

    fn side(&mut self, from: u32, to: u32, p: DVec2) -> Sign {
        self.steps += 1;
        orient2d(self.at(from), self.at(to), p)
    }

    /// Around the origin of `h`, whose triangle is finite; `p` is not that vertex.
    fn turn(&mut self, p: DVec2, h: u32, limit: u64) -> Option<Step> {
        let mesh = self.mesh;
        let v = mesh.origin(h);
        let mut h = h;
        match self.side(v, mesh.destination(h), p) {
            Sign::Zero if order_on_ray(self.at(v), p, self.at(mesh.destination(h))) != Between::Behind => {
                return Some(Step::Along(h));
            }
            // Clockwise, as long as p is right of the edge.
            Sign::Negative => {
                while self.steps < limit {
                    let g = mesh.twin(h);
                    if mesh.apex(g) == GHOST {
                        return Some(Step::Found(Place::Outside(g / 3)));
                    }
                    h = next(g);
                    match self.side(v, mesh.destination(h), p) {
                        Sign::Positive => return Some(Step::Into(h)),
                        Sign::Zero => return Some(Step::Along(h)),
                        Sign::Negative => {}
                    }
                }
            }
            // Counterclockwise, as long as p is left of the edge; straight behind is left of the next one.
            _ => {
                while self.steps < limit {
                    if mesh.apex(h) == GHOST {
                        return Some(Step::Found(Place::Outside(h / 3)));
                    }
                    let following = mesh.rotate_ccw(h);
                    match self.side(v, mesh.destination(following), p) {
                        Sign::Negative => return Some(Step::Into(h)),
                        Sign::Zero => return Some(Step::Along(following)),
                        Sign::Positive => h = following,
                    }
                }
            }
        }
        None
    }

    /// Along the ray of `h`: the place of `p`, or nothing if it lies beyond the destination.
    fn along(&self, p: DVec2, h: u32) -> Option<Place> {
        let (v, w) = (self.mesh.origin(h), self.mesh.destination(h));
        match order_on_ray(self.at(v), p, self.at(w)) {
            Between::End => Some(Place::Vertex(w)),
            Between::Inside => Some(Place::Edge(h)),
            _ => None,
        }
    }

    /// From the origin of `h` into its triangle and through the ones behind it.
    fn cross(&mut self, p: DVec2, h: u32, limit: u64) -> Option<Step> {
        let mesh = self.mesh;
        let start = mesh.origin(h);
        // The edge by which the segment leaves, from its right end to its left.
        let mut exit = next(h);
        while self.steps < limit {
            match self.side(mesh.origin(exit), mesh.destination(exit), p) {
                Sign::Positive => return Some(Step::Found(Place::Inside(exit / 3))),
                Sign::Zero => return Some(Step::Found(Place::Edge(exit))),
                Sign::Negative => {}
            }
            let entry = mesh.twin(exit);
            let c = mesh.apex(entry);
            if c == GHOST {
                return Some(Step::Found(Place::Outside(entry / 3)));
            }
            exit = match self.side(start, c, p) {
                // The corner is right of the segment: out between it and the left end.
                Sign::Positive => prev(entry),
                Sign::Negative => next(entry),
                Sign::Zero => {
                    return Some(match order_on_ray(self.at(start), p, self.at(c)) {
                        Between::End => Step::Found(Place::Vertex(c)),
                        Between::Inside => Step::Found(Place::Inside(entry / 3)),
                        _ => Step::Through(prev(entry)),
                    });
                }
            };
        }
        None
    }
}

/// Where a point lies on the line through two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Between {
    /// Before the first, or on it.
    Behind,
    Inside,
    /// On the second.
    End,
    Beyond,
}

/// Where `p` lies on the line from `v` to `w`, which differ.
fn order_on_ray(v: DVec2, p: DVec2, w: DVec2) -> Between {
    let (v, p, w) = if v.x == w.x { (v.y, p.y, w.y) } else { (v.x, p.x, w.x) };
    let (v, p, w) = if v < w { (v, p, w) } else { (-v, -p, -w) };
    if p <= v {
        Between::Behind
    } else if p < w {
        Between::Inside
    } else if p == w {
        Between::End
    } else {
        Between::Beyond
    }
}
