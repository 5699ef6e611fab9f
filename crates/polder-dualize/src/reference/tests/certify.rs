use super::{delaunay, lattice};
use crate::DualizeError;
use crate::reference::certify;
use glam::DVec2;
use polder_flip::reference::chain;
use polder_mesh::{GHOST, GhostMesh};

/// Links triangles by their edges.
fn linked(triangles: Vec<[u32; 3]>) -> GhostMesh {
    let mut mesh = GhostMesh::with_slots(triangles.len());
    mesh.triangles = triangles;
    let all = 0..3 * mesh.slots() as u32;
    for h in all.clone() {
        let other = |&g: &u32| mesh.origin(g) == mesh.destination(h) && mesh.destination(g) == mesh.origin(h);
        let g = all.clone().find(other).unwrap();
        mesh.link(h, g);
    }
    mesh.check().unwrap();
    mesh
}

/// Every triangle is counterclockwise, every link right, the hull turns left everywhere, and the number of triangles is
/// that of a sphere: but the triangles wind round the middle twice.
#[test]
fn a_hull_that_winds_twice_is_refused() {
    let star: Vec<DVec2> = (0..5).map(|i| DVec2::from_angle(std::f64::consts::TAU * 0.4 * f64::from(i))).collect();
    let positions = [star, vec![DVec2::ZERO]].concat();
    let around = (0..5).map(|i| (i, (i + 1) % 5));
    let triangles = around.flat_map(|(i, j)| [[5, i, j], [j, i, GHOST]]).collect();
    let mesh = linked(triangles);
    assert_eq!(mesh.slots(), 2 * 6 - 2);
    let expected = DualizeError::HullWinds { stage: "test", times: 2 };
    assert_eq!(certify(&mesh, &positions, "test"), Err(expected));
}

#[test]
fn a_notch_in_the_hull_is_refused() {
    let mut positions = vec![DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(4.0, 4.0), DVec2::new(0.0, 4.0)];
    positions.push(DVec2::new(2.0, 1.0));
    let inner = [[4, 1, 2], [4, 2, 3], [4, 3, 0]];
    let outer = [[2, 1, GHOST], [3, 2, GHOST], [0, 3, GHOST], [4, 0, GHOST], [1, 4, GHOST]];
    let mesh = linked([&inner[..], &outer[..]].concat());
    let error = certify(&mesh, &positions, "test").unwrap_err();
    assert!(matches!(error, DualizeError::HullNotConvex { vertex: 4, .. }), "{error}");
}

#[test]
fn a_flat_triangle_is_refused() {
    let mut positions = lattice(3, 3);
    let mesh = delaunay(&positions);
    certify(&mesh, &positions, "test").unwrap();
    positions[4] = positions[0];
    assert!(matches!(
        certify(&mesh, &positions, "test").unwrap_err(),
        DualizeError::NotCounterclockwise { stage: "test", .. }
    ));
}

#[test]
fn a_chain_passes_unless_it_folds_back() {
    let line = |xs: &[f64]| xs.iter().map(|&x| DVec2::new(x, -x)).collect::<Vec<_>>();
    let mesh = chain(&[0, 1, 2, 3]);
    certify(&mesh, &line(&[0.0, 1.0, 2.0, 5.0]), "test").unwrap();
    certify(&mesh, &line(&[5.0, 2.0, 1.0, 0.0]), "test").unwrap();
    let error = certify(&mesh, &line(&[0.0, 2.0, 1.0, 5.0]), "test").unwrap_err();
    assert!(matches!(error, DualizeError::HullNotConvex { .. }), "{error}");
    let error = certify(&mesh, &[0.0, 1.0, 2.0, 5.0].map(|x| DVec2::new(x, x * x)), "test").unwrap_err();
    assert!(matches!(error, DualizeError::HullNotConvex { .. }), "{error}");
    certify(&GhostMesh::default(), &[], "test").unwrap();
}
