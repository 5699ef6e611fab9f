use super::{lattice, scattered};
use crate::Inserted;
use crate::reference::{ToInsert, insert};
use glam::DVec2;
use polder_flip::reference::chain;
use polder_mesh::{GhostMesh, NONE};

/// Inserts all points but those of a chain into it.
fn from_chain(vertices: &[u32], positions: &[DVec2]) -> Inserted {
    let points: Vec<u32> = (0..positions.len() as u32).filter(|v| !vertices.contains(v)).collect();
    let starts = vec![NONE; points.len()];
    let mesh = chain(vertices);
    let new = ToInsert::into_free_slots(&mesh, points, starts);
    let inserted = insert(mesh, positions, &new).unwrap();
    inserted.mesh.check().unwrap();
    let mut distinct = inserted.vertex_of.clone();
    distinct.sort_unstable();
    distinct.dedup();
    let expected = if distinct.len() < 2 { 0 } else { 2 * distinct.len() - 2 };
    let used = (0..inserted.mesh.slots()).filter(|&t| !inserted.mesh.is_deleted(t)).count();
    assert_eq!(used, expected);
    for (point, &v) in inserted.vertex_of.iter().enumerate() {
        assert_eq!(positions[point], positions[v as usize]);
    }
    inserted
}

#[test]
fn from_nothing() {
    assert_eq!(insert(GhostMesh::default(), &[], &ToInsert::default()).unwrap(), Inserted::default());
    for n in [1, 2, 3, 4, 10, 1000] {
        let inserted = from_chain(&[], &scattered(n));
        assert!(inserted.bootstrapped);
        assert_eq!(inserted.duplicates, 0);
    }
    from_chain(&[], &lattice(20, 20));
    from_chain(&[], &[DVec2::ZERO, DVec2::ZERO, DVec2::X, DVec2::X, DVec2::Y, DVec2::Y]);
}

#[test]
fn from_a_chain_with_points_on_its_line_and_off_it() {
    let mut positions = lattice(7, 3);
    from_chain(&[7, 8, 9, 12, 13], &positions);
    from_chain(&[14, 1], &positions);
    from_chain(&[20, 19, 18], &positions);
    positions.extend(lattice(7, 3));
    from_chain(&[7, 8, 9, 12, 13], &positions);
    let apex_right = [DVec2::ZERO, DVec2::X, DVec2::new(2.0, 0.0), DVec2::new(1.0, -1.0)];
    let inserted = from_chain(&[2, 1, 0], &apex_right);
    assert_eq!(inserted.mesh.finite().count(), 2);
}

#[test]
fn points_all_on_one_line_end_as_a_chain() {
    let line: Vec<DVec2> = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0].map(|x| DVec2::new(x, 2.0 * x)).to_vec();
    for start in [&[][..], &[0, 2], &[1, 0, 5]] {
        let inserted = from_chain(start, &line);
        assert_eq!(inserted.mesh.finite().count(), 0);
        assert_eq!(inserted.duplicates, 1);
        assert_eq!(inserted.vertex_of[3], 1);
    }
}

#[test]
fn points_all_equal_end_as_the_empty_mesh() {
    let zeros = [DVec2::new(0.0, -0.0), DVec2::new(-0.0, 0.0), DVec2::ZERO];
    let inserted = from_chain(&[], &zeros);
    assert_eq!((inserted.mesh.slots(), inserted.duplicates), (0, 2));
    let order = [2, 0, 1];
    let names = inserted.names(&order);
    assert_eq!(inserted.representatives(&order, &names), [0, 0, 0]);
}
