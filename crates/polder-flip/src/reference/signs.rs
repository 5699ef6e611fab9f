//! The predicates for many tuples of vertices: what the kernels of the same names give.

use glam::DVec2;
use polder_predicates::{must_flip, orient2d};

/// The signs of the orientations of triples: -1, 0 or 1. `None` if a vertex has no position.
pub fn orient2d_signs(positions: &[DVec2], triples: &[[u32; 3]]) -> Option<Vec<i32>> {
    let at = |v: u32| positions.get(v as usize).copied();
    triples.iter().map(|&[a, b, c]| Some(orient2d(at(a)?, at(b)?, at(c)?) as i32)).collect()
}

/// Whether the edge `bc` of the triangles `abc` and `dcb` must be flipped to `ad`, for quadruples `[a, b, c, d]`: 1 or 0.
/// `None` if a vertex has no position.
pub fn must_flip_signs(positions: &[DVec2], quadruples: &[[u32; 4]]) -> Option<Vec<i32>> {
    let at = |v: u32| positions.get(v as usize).copied();
    quadruples.iter().map(|&[a, b, c, d]| Some(must_flip(at(a)?, at(b)?, at(c)?, at(d)?).into())).collect()
}
