//! The bad case of [QCT] section 4.4.
#![allow(clippy::unwrap_used, reason = "tests")]

use glam::DVec2;
use polder_mesh::GhostMesh;

/// The bad case of [QCT] figure 7 for any k, with its ends: 2k - 1 concave pairs, then 4k - 1 double ones.
///
/// A constraint along the x axis. Above it a row of points, below it another, both bulging towards it, so that no three
/// neighbors in a row make a convex corner. From the first lower point a fan reaches the upper points on the left (the
/// concave pairs); then a zigzag goes on between both rows (double pairs, no three in a row of which form a convex
/// pentagon). The one way on in the middle is case 3 at the last concave pair, which pushes it one step to the right;
/// then the one before it can follow. The ends are eaten away one pair a round, so they are k pairs longer than the
/// pushing takes.
fn bad_case(k: usize) -> (GhostMesh, Vec<DVec2>, [u32; 2]) {
    let (fan, zigzag) = (2 * k, 2 * k);
    let count = fan + zigzag + 1;
    let mut positions = vec![DVec2::new(-1.0, 0.0), DVec2::new(count as f64, 0.0)];
    let row = |x: usize, side: f64| {
        let off = x as f64 - count as f64 / 2.0;
        DVec2::new(x as f64, side * (1.0 + off * off / (count * count) as f64))
    };
    positions.extend((0..count).map(|x| row(x, 1.0)));
    positions.extend((fan..count).map(|x| row(x, -1.0)));
    let upper = |i: usize| 2 + i as u32;
    let lower = |i: usize| (2 + count + i) as u32;
    let mut triangles = vec![[0, lower(0), upper(0)]];
    triangles.extend((0..fan).map(|i| [lower(0), upper(i + 1), upper(i)]));
    for i in 0..zigzag {
        triangles.push([lower(i), lower(i + 1), upper(fan + i)]);
        triangles.push([lower(i + 1), upper(fan + i + 1), upper(fan + i)]);
    }
    triangles.push([lower(zigzag), 1, upper(fan + zigzag)]);
    (close(&triangles), positions, [0, 1])
}

/// A mesh from counterclockwise triangles whose boundary is one closed line: linked, and joined to the ghost.
fn close(triangles: &[[u32; 3]]) -> GhostMesh {
    let n = triangles.len();
    let mut mesh = GhostMesh::with_slots(n);
    mesh.triangles.copy_from_slice(triangles);
    let mut edges: Vec<(u32, u32, u32)> = Vec::new();
    for h in 0..3 * n as u32 {
        edges.push((mesh.origin(h), mesh.destination(h), h));
    }
    edges.sort_unstable();
    let find =
        |edges: &[(u32, u32, u32)], a, b| edges.binary_search_by_key(&(a, b), |e| (e.0, e.1)).ok().map(|i| edges[i].2);
    let mut border = Vec::new();
    for &(a, b, h) in &edges {
        match find(&edges, b, a) {
            Some(g) => mesh.link(h, g),
            None => border.push((a, b, h)),
        }
    }
    for (i, &(a, b, h)) in border.iter().enumerate() {
        mesh.triangles.push([b, a, polder_mesh::GHOST]);
        mesh.links.push([polder_mesh::NONE; 3]);
        mesh.constrained.push(0);
        mesh.link(h, 3 * (n + i) as u32 + 2);
    }
    for (i, &(_, b, _)) in border.iter().enumerate() {
        let following = border.iter().position(|e| e.0 == b).unwrap();
        mesh.link(3 * (n + i) as u32 + 1, 3 * (n + following) as u32);
    }
    mesh
}

/// The same, but the hull is closed by ghost flips.
pub(crate) fn bad_mesh(k: usize) -> (GhostMesh, Vec<DVec2>, [u32; 2]) {
    let (mut mesh, positions, ends) = bad_case(k);
    mesh.check().unwrap();
    polder_flip::reference::close_hull(&mut mesh, &positions).unwrap();
    (mesh, positions, ends)
}
