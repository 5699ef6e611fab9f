//! Equal points, and whether every point is used.

use super::mesh::Mesh;
use super::verdict::{Found, Kind, Place};
use glam::DVec2;
use polder_mesh::NONE;
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;
use std::cmp::Ordering;

/// By x, then by y; -0.0 equals 0.0.
pub(super) fn compare(a: DVec2, b: DVec2) -> Ordering {
    let coordinate = |a: f64, b: f64| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    coordinate(a.x, b.x).then(coordinate(a.y, b.y))
}

/// A hash of a point's value: -0.0 and 0.0 have the same one.
fn hash(p: DVec2) -> u32 {
    let mix = |x: u64| (x ^ x >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    let bits = mix(mix((p.x + 0.0).to_bits()).rotate_left(17) ^ (p.y + 0.0).to_bits());
    (mix(bits) >> 32) as u32
}

/// For each point the lowest point equal to it. Points are sorted by a hash, points of one hash by value.
pub(super) fn representatives(points: &[DVec2]) -> Vec<u32> {
    let mut keys: Vec<u64> = points.par_iter().enumerate().map(|(i, &p)| u64::from(hash(p)) << 32 | i as u64).collect();
    keys.par_sort_unstable();

    let mut out: Vec<u32> = (0..points.len() as u32).collect();
    let mut group = Vec::new();
    for keys in keys.chunk_by(|a, b| a >> 32 == b >> 32).filter(|keys| keys.len() > 1) {
        group.clear();
        group.extend(keys.iter().map(|&key| key as u32));
        group.par_sort_unstable_by(|&i, &j| compare(points[i as usize], points[j as usize]).then(i.cmp(&j)));
        for equal in group.chunk_by(|&i, &j| points[i as usize] == points[j as usize]) {
            equal.iter().for_each(|&i| out[i as usize] = equal[0]);
        }
    }
    out
}

/// Whether all points lie on one line (or there are fewer than three different ones).
pub(super) fn on_one_line(points: &[DVec2]) -> bool {
    let Some(&first) = points.first() else { return true };
    let Some(&second) = points.iter().find(|&&p| p != first) else { return true };
    points.par_iter().all(|&p| orient2d(first, second, p) == Sign::Zero)
}

/// Every distinct point is a vertex, under one name.
pub(super) fn check_used(mesh: &Mesh<'_>, representatives: &[u32], triangles: &[[u32; 3]], found: &mut Found) {
    if triangles.is_empty() {
        if !on_one_line(mesh.points) {
            found.add(Kind::Empty, Place::Mesh);
        }
        return;
    }
    found.sweep(representatives.len(), |range, found| {
        for v in range {
            if representatives[v] == v as u32 && mesh.degree(v as u32) == 0 {
                found.add(Kind::UnusedPoint, Place::Point(v as u32));
            }
        }
    });

    if representatives.par_iter().enumerate().all(|(i, &v)| i as u32 == v) {
        return;
    }
    let mut name = vec![NONE; representatives.len()];
    for &corner in triangles.iter().flatten() {
        let Some(&v) = representatives.get(corner as usize) else { continue };
        let name = &mut name[v as usize];
        if *name == NONE {
            *name = corner;
        } else if *name != corner && *name != NONE - 1 {
            found.add(Kind::TwoNames, Place::Point(v));
            *name = NONE - 1;
        }
    }
}
