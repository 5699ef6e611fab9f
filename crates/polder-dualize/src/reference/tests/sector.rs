use super::{delaunay, lattice};
use crate::reference::sector::{Center, sector};
use crate::reference::{ToInsert, insert};
use glam::DVec2;
use polder_mesh::GhostMesh;

fn ghosts(mesh: &GhostMesh) -> impl Iterator<Item = u32> + '_ {
    (0..mesh.slots()).filter(|&t| mesh.is_ghost(t)).map(|t| t as u32)
}

/// Every point outside belongs to one ghost triangle, wherever the search starts, also where it is on the line of a
/// hull edge or straight out from a corner; with the center infinitely near a corner of the hull as well as inside.
#[test]
fn sectors_cover_the_outside_once() {
    let at = lattice(3, 3);
    let mesh = delaunay(&at);
    let outside = lattice(9, 9).into_iter().map(|p| p - DVec2::splat(3.0));
    let outside: Vec<DVec2> = outside.filter(|p| p.min_element() < 0.0 || p.max_element() > 2.0).collect();
    for t in mesh.finite() {
        for turn in 0..3 {
            let mut corners = mesh.triangles[t].map(|v| at[v as usize]);
            corners.rotate_left(turn);
            let center = Center(corners);
            for &p in &outside {
                let mut found: Vec<u32> =
                    ghosts(&mesh).map(|g| sector(&mesh, &at, &center, p, g, &mut 0).unwrap()).collect();
                found.dedup();
                assert_eq!(found.len(), 1, "{p} from {corners:?}");
            }
        }
    }
}

/// Two points beyond neighboring hull edges, such that the triangles from these edges overlap: each point sees both
/// edges, and each walk ends at the other one's.
#[test]
fn winners_at_neighboring_hull_edges_do_not_overlap() {
    let base = [DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(5.0, 1.0)];
    for (p, q) in [(2.0, 8.0), (8.0, 2.0), (4.0, 6.0), (1.0, 9.5)] {
        for (height, starts) in [(3.0, [0, 1]), (50.0, [0, 1]), (50.0, [2, 2]), (4.0, [1, 0])] {
            let ends = [DVec2::new(p, height), DVec2::new(q, height)];
            let positions = [&base[..], &ends].concat();
            let mesh = delaunay(&base);
            // The certificate at the end of the stage is the check.
            let new = ToInsert::into_free_slots(&mesh, vec![3, 4], starts.to_vec());
            let inserted = insert(mesh, &positions, &new).unwrap();
            assert_eq!(inserted.mesh.slots(), 2 * 5 - 2);
        }
    }
}

/// Many points all round, none inside: every round has winners in many sectors.
#[test]
fn points_all_round_a_small_triangle_are_inserted() {
    let mut positions = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    let mesh = delaunay(&positions);
    positions.extend((0..500).map(|i| DVec2::from_angle(f64::from(i)) * (2.0 + f64::from(i % 7))));
    let points: Vec<u32> = (3..503).collect();
    let new = ToInsert::into_free_slots(&mesh, points, vec![0; 500]);
    let inserted = insert(mesh, &positions, &new).unwrap();
    assert_eq!((inserted.inserted, inserted.mesh.slots()), (500, 2 * 503 - 2));
    assert!(inserted.rounds < 20, "{} rounds", inserted.rounds);
}
