use super::{delaunay, lattice, scattered, slivers};
use crate::DualizeError;
use crate::reference::locate::{Place, Walk};
use glam::DVec2;
use polder_mesh::GhostMesh;
use polder_predicates::{Sign, orient2d};

/// The place of a point by trying everything.
fn by_trying(mesh: &GhostMesh, at: &[DVec2], p: DVec2) -> Place {
    if let Some(v) = at.iter().position(|&q| q == p) {
        return Place::Vertex(v as u32);
    }
    for t in mesh.finite() {
        let corners = mesh.triangles[t].map(|v| at[v as usize]);
        let signs = [0, 1, 2].map(|k| orient2d(corners[(k + 1) % 3], corners[(k + 2) % 3], p));
        if signs.iter().all(|&s| s == Sign::Positive) {
            return Place::Inside(t as u32);
        }
        if signs.iter().all(|&s| s != Sign::Negative) {
            let k = signs.iter().position(|&s| s == Sign::Zero).unwrap() as u32;
            return Place::Edge(3 * t as u32 + k);
        }
    }
    Place::Outside(0)
}

/// From every half-edge of the mesh to every point.
fn check(mesh: &GhostMesh, at: &[DVec2], points: &[DVec2]) -> u64 {
    let vertices = at.len();
    let positions = [at, points].concat();
    let mut walk = Walk { mesh, positions: &positions, steps: 0 };
    for (i, &p) in positions.iter().enumerate().skip(vertices) {
        let expected = by_trying(mesh, at, p);
        for from in 0..3 * mesh.slots() as u32 {
            let found = walk.locate(i as u32, from).unwrap();
            let same = match (found, expected) {
                (Place::Edge(h), Place::Edge(g)) => h == g || mesh.twin(h) == g,
                (Place::Outside(ghost), Place::Outside(_)) => {
                    // It must lie strictly beyond the hull edge of that ghost triangle.
                    let k = (0..3).find(|k| mesh.apex(3 * ghost + k) == polder_mesh::GHOST).unwrap();
                    let h = mesh.twin(3 * ghost + k);
                    let ends = [mesh.origin(h), mesh.destination(h)].map(|v| at[v as usize]);
                    orient2d(ends[0], ends[1], p) == Sign::Negative
                }
                (a, b) => a == b,
            };
            assert!(same, "{p} from {from}: {found:?}, not {expected:?}\n{mesh}");
        }
    }
    walk.steps
}

/// All vertices, points on edges, points outside and straight on from hull edges.
fn halves(width: i32, height: i32) -> Vec<DVec2> {
    let row = |y: i32| (-3..2 * width + 2).map(move |x| DVec2::new(0.5 * f64::from(x), 0.5 * f64::from(y)));
    (-3..2 * height + 2).flat_map(row).collect()
}

#[test]
fn walks_through_vertices_and_along_edges_are_exact() {
    let at = lattice(4, 3);
    check(&delaunay(&at), &at, &halves(4, 3));
    check(&slivers(&at), &at, &halves(4, 3));
    let thirds: Vec<DVec2> = halves(4, 3).into_iter().map(|p| p * (2.0 / 3.0)).collect();
    check(&slivers(&at), &at, &thirds);
}

/// A walk that always turns to the first edge it is beyond can go round in circles where the triangulation is not
/// Delaunay; a straight one cannot.
#[test]
fn walks_end_where_the_triangulation_is_not_delaunay() {
    let at = scattered(60);
    let points = scattered(120).split_off(60);
    check(&slivers(&at), &at, &points);
    // A spiral of slivers around the middle.
    let ring = |i: u32| DVec2::from_angle(0.7 * f64::from(i)) * (1.0 + 0.3 * f64::from(i));
    let at: Vec<DVec2> = (0..40).map(ring).collect();
    check(&slivers(&at), &at, &points.iter().map(|&p| 10.0 * p - DVec2::splat(5.0)).collect::<Vec<_>>());
}

/// A mesh that has nothing to do with its positions: whatever a walk does there, it ends.
#[test]
fn walks_end_where_the_mesh_is_no_triangulation() {
    let at = lattice(5, 5);
    let mesh = delaunay(&at);
    let mixed: Vec<DVec2> = (0..25).map(|i| at[i * 7 % 25]).collect();
    let positions = [mixed, vec![DVec2::new(2.1, 1.3)]].concat();
    let mut walk = Walk { mesh: &mesh, positions: &positions, steps: 0 };
    let mut lost = 0;
    for from in 0..3 * mesh.slots() as u32 {
        match walk.locate(25, from) {
            Ok(_) => {}
            Err(DualizeError::WalkLost { point: 25, .. }) => lost += 1,
            Err(error) => panic!("{error}"),
        }
    }
    assert!(lost > 0);
}
