use super::{delaunay, lattice, scattered};
use crate::reference::certify;
use crate::reference::takeout::take_out;
use glam::DVec2;
use polder_flip::reference::chain;
use polder_mesh::{GhostMesh, NONE};
use polder_predicates::{Sign, orient2d};

/// Takes vertices out and checks what is left; returns the mesh and the heirs.
fn check(mesh: GhostMesh, at: &[DVec2], pinned: &[u32]) -> (GhostMesh, Vec<u32>, u64) {
    let mut mesh = mesh;
    let mut flags = vec![false; at.len()];
    pinned.iter().for_each(|&v| flags[v as usize] = true);
    let slots = mesh.slots();
    let taken = take_out(&mut mesh, at, flags, &mut || Ok(())).unwrap();
    mesh.check().unwrap();
    certify(&mesh, at, "test").unwrap();
    let mut free: Vec<u32> = taken.freed.iter().flatten().copied().filter(|&t| t != NONE).collect();
    free.sort_unstable();
    let deleted: Vec<u32> = (0..mesh.slots() as u32).filter(|&t| mesh.is_deleted(t as usize)).collect();
    assert_eq!(free, deleted);
    assert!(mesh.slots() == slots || mesh.slots() == 0);
    if mesh.slots() > 0 {
        assert!((0..at.len() as u32).all(|v| (taken.freed[v as usize] != [NONE; 2]) == pinned.contains(&v)));
        assert_eq!(deleted.len(), 2 * pinned.len());
    }
    let still_there = mesh.half_edge_of_vertex(at.len());
    for v in 0..at.len() as u32 {
        let heir = taken.heirs[v as usize];
        let gone = pinned.contains(&v);
        if mesh.slots() == 0 {
            assert_eq!(heir, NONE);
        } else {
            assert_eq!(heir == v, !gone, "{v} -> {heir}");
            assert_ne!(still_there[heir as usize], NONE, "{v} -> {heir} is not there");
        }
    }
    (mesh, taken.heirs, taken.rounds)
}

/// The middle of a lattice lies on both diagonals of its four neighbors: no ear whose diagonal passes strictly beside
/// it exists.
#[test]
fn the_diagonal_of_an_ear_may_pass_through_the_vertex() {
    let at = [DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0), DVec2::new(-1.0, 0.0), DVec2::new(0.0, -1.0)];
    let mesh = delaunay(&at);
    assert_eq!(mesh.finite().count(), 4);
    for (a, b) in [(1, 3), (2, 4)] {
        assert_eq!(orient2d(at[a], at[b], at[0]), Sign::Zero);
    }
    check(mesh, &at, &[0]);
}

#[test]
fn every_set_of_vertices_can_be_taken_out_of_a_small_lattice() {
    for (width, height) in [(3, 3), (5, 2), (4, 1), (1, 3)] {
        let at = lattice(width, height);
        let mesh = delaunay(&at);
        for set in 0..1u32 << at.len() {
            let pinned: Vec<u32> = (0..at.len() as u32).filter(|v| set >> v & 1 == 1).collect();
            check(mesh.clone(), &at, &pinned);
        }
    }
}

#[test]
fn whole_rows_of_a_lattice_are_taken_out() {
    let at = lattice(30, 30);
    let rows: Vec<u32> = (0..900).filter(|v| v / 30 % 3 != 1).collect();
    let (_, _, rounds) = check(delaunay(&at), &at, &rows);
    assert!(rounds < 40, "{rounds} rounds");
    let inner: Vec<u32> = (0..900).filter(|v| (1..29).contains(&(v / 30)) && (1..29).contains(&(v % 30))).collect();
    check(delaunay(&at), &at, &inner);
    let hull: Vec<u32> = (0..900).filter(|v| !inner.contains(v)).collect();
    check(delaunay(&at), &at, &hull);
}

/// Stars of very high degree: a hub inside, a hub on the hull before a hollow row, and one before a bulging row.
#[test]
fn stars_of_very_high_degree_are_taken_out() {
    let n = 20_000;
    let on_circle = |i: u32| DVec2::from_angle(std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(n));
    let mut at = vec![DVec2::ZERO];
    at.extend((0..n).map(on_circle));
    check(hub(&at, true), &at, &[0]);

    for bulge in [1.0, -1.0] {
        let row = |i: u32| DVec2::new(f64::from(i) - 1e4, 1e5 - bulge * (f64::from(i) / 1e4 - 1.0).powi(2));
        let mut at = vec![DVec2::new(0.0, -1e5)];
        at.extend((0..n).rev().map(row));
        let mut mesh = hub(&at, false);
        polder_flip::reference::close_hull(&mut mesh, &at).unwrap();
        check(mesh, &at, &[0]);
    }
}

/// Vertex 0 in one triangle with each pair of successive others; all round, or open from the last to the first.
fn hub(at: &[DVec2], closed: bool) -> GhostMesh {
    let last = at.len() as u32 - 1;
    let pairs = (1..last).map(|i| (i, i + 1)).chain(closed.then_some((last, 1)));
    let mut mesh = GhostMesh::default();
    for (i, j) in pairs.clone() {
        mesh.triangles.push([0, i, j]);
        mesh.triangles.push([j, i, polder_mesh::GHOST]);
    }
    if !closed {
        mesh.triangles.extend([[1, 0, polder_mesh::GHOST], [0, last, polder_mesh::GHOST]]);
    }
    mesh.links = vec![[NONE; 3]; mesh.triangles.len()];
    mesh.constrained = vec![0; mesh.triangles.len()];
    let mut sides: Vec<_> = (0..3 * mesh.slots() as u32)
        .map(|h| (mesh.origin(h).min(mesh.destination(h)), mesh.origin(h).max(mesh.destination(h)), h))
        .collect();
    sides.sort_unstable();
    sides.chunks(2).for_each(|pair| mesh.link(pair[0].2, pair[1].2));
    mesh
}

/// All but a few are taken out, so that most heirs go as well.
#[test]
fn heirs_are_followed_to_vertices_that_are_still_there() {
    let at = scattered(2000);
    let pinned: Vec<u32> = (0..2000).filter(|v| v % 50 != 7).collect();
    let (_, heirs, _) = check(delaunay(&at), &at, &pinned);
    // Nothing is too far from its heir, or searches would be slow: 40 vertices are left, about 0.16 apart.
    let far = pinned.iter().filter(|&&v| at[v as usize].distance(at[heirs[v as usize] as usize]) > 0.6).count();
    assert!(far < 100, "{far} far heirs");
}

#[test]
fn a_triangle_becomes_a_chain_and_a_chain_with_pinned_vertices_becomes_empty() {
    let at = [DVec2::ZERO, DVec2::X, DVec2::Y];
    let (mesh, heirs, _) = check(delaunay(&at), &at, &[2]);
    assert_eq!((mesh.finite().count(), mesh.slots()), (0, 4));
    assert_eq!(heirs, [0, 1, 0]);
    for pinned in [&[0, 2][..], &[0, 1, 2]] {
        let (mesh, heirs, _) = check(delaunay(&at), &at, pinned);
        assert_eq!((mesh.slots(), heirs), (0, vec![NONE; 3]));
    }
    let line: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i), f64::from(2 * i))).collect();
    for set in 0..1u32 << 9 {
        let pinned: Vec<u32> = (0..9).filter(|v| set >> v & 1 == 1).collect();
        check(chain(&[0, 1, 2, 3, 4, 5, 6, 7, 8]), &line, &pinned);
    }
}
