//! Putting one vertex into a triangle or an edge: topology alone. Ghost triangles are triangles like others.

use polder_mesh::{GhostMesh, next, prev};

/// Splits triangle `t` at a new vertex into three; two of them go to the slots `s` and `s + 1`, which are free.
///
/// With corners `a, b, c` before, slot `t` has `a, b, p` after, `s` has `b, c, p` and `s + 1` has `c, a, p`. Edge 2 of
/// each is the outer one.
pub(super) fn into_triangle(mesh: &mut GhostMesh, t: u32, p: u32, s: u32) {
    let [a, b, c] = mesh.triangles[t as usize];
    let outer = [3 * t, 3 * t + 1].map(|h| mesh.twin(h));
    mesh.triangles[t as usize][2] = p;
    mesh.triangles[s as usize] = [b, c, p];
    mesh.triangles[s as usize + 1] = [c, a, p];
    let ring = [t, s, s + 1];
    for (i, &from) in ring.iter().enumerate() {
        mesh.link(3 * from, 3 * ring[(i + 1) % 3] + 1);
    }
    mesh.link(3 * s + 2, outer[0]);
    mesh.link(3 * (s + 1) + 2, outer[1]);
}

/// Splits the edge `h` at a new vertex, and its two triangles with it; two of the four that result go to the slots `s`
/// and `s + 1`, which are free.
///
/// With `h` from `a` to `b` of triangle `c, a, b` and across it `d, b, a`: the half-edges `h` and its twin now lead
/// from `a` and `b` to the new vertex, slot `s` has `c, p, b` and `s + 1` has `d, p, a`.
pub(super) fn into_edge(mesh: &mut GhostMesh, h: u32, p: u32, s: u32) {
    let g = mesh.twin(h);
    let sides = [(h, s), (g, s + 1)];
    let outer = [h, g].map(|side| mesh.twin(next(side)));
    for ((side, new), outer) in sides.into_iter().zip(outer) {
        let (apex, end) = (mesh.apex(side), mesh.destination(side));
        mesh.triangles[new as usize] = [apex, p, end];
        mesh.triangles[(side / 3) as usize][prev(side) as usize % 3] = p;
        mesh.link(next(side), 3 * new + 2);
        mesh.link(3 * new + 1, outer);
    }
    mesh.link(h, 3 * (s + 1));
    mesh.link(g, 3 * s);
}
