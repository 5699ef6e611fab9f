//! Every error, from the input that causes it.

use polder_dualize::reference::{self, ToInsert};
use polder_dualize::{DVec2, DualizeError};
use polder_mesh::{GhostMesh, NONE};
use polder_voronoi::{Diagram, Options, Sites, UNCOLORED, VoronoiError};

fn grid(rows: &[&str], pixels: &[[u16; 2]]) -> (Diagram, Sites) {
    // Rows as they are read, the highest first; colors are letters.
    let (width, height) = (rows[0].len() as u32, rows.len() as u32);
    let color = |b: u8| if b == b'.' { UNCOLORED } else { u32::from(b - b'A') };
    let colors = rows.iter().rev().flat_map(|row| row.bytes().map(color)).collect();
    let order = (0..pixels.len() as u32).collect();
    let sites = Sites { size: [width, height], order, count: pixels.len(), pixels: pixels.to_vec() };
    (Diagram { width, height, colors, debris: Vec::new() }, sites)
}

#[test]
fn crossing_necks_are_named() {
    let (diagram, sites) = grid(&["AAAB", "AABB", "BBAA", "BBAA"], &[[0, 0], [3, 0]]);
    assert_eq!(reference::dualize(&diagram, &sites), Err(DualizeError::CrossingNecks { x: 2, y: 2 }));
}

#[test]
fn holes_and_islands_are_refused() {
    let hole = grid(&["AAA", "ABA", "AAA"], &[[0, 0], [1, 1]]);
    let island = grid(&["AAABBBA"], &[[0, 0], [3, 0]]);
    for ((diagram, sites), triangles) in [(hole, 0), (island, 4)] {
        let expected = DualizeError::NotASphere { triangles, sites: 2, expected: 2 };
        assert_eq!(reference::dualize(&diagram, &sites), Err(expected));
    }
    // The right number of triangles, but of a region too few and one that is in two pieces.
    let (diagram, sites) = grid(&["AABBAA"], &[[0, 0], [2, 0], [5, 0]]);
    let expected = DualizeError::Mismatch { what: "a site that no region belongs to", index: 2 };
    assert_eq!(reference::dualize(&diagram, &sites), Err(expected));
}

#[test]
fn triangles_that_are_turned_over_are_refused() {
    // Connected regions, but not those of flooding: B and C have changed places.
    let (diagram, sites) = grid(&["AAAA", "CCBB", "CCBB"], &[[0, 0], [3, 0], [1, 2]]);
    let (mut wrong, _) = grid(&["AAAA", "CCBB", "CCBB"], &[]);
    wrong.colors.iter_mut().for_each(|c| *c = [2, 1, 0][*c as usize]);
    reference::dualize(&wrong, &sites).unwrap();
    let error = reference::dualize(&diagram, &sites).unwrap_err();
    assert!(matches!(error, DualizeError::NotCounterclockwise { stage: "dualize", .. }), "{error}");
}

#[test]
fn diagrams_that_do_not_fit_their_sites_are_refused() {
    let (good, sites) = grid(&["AAABBB"], &[[0, 0], [5, 0]]);
    reference::dualize(&good, &sites).unwrap();
    let index = |diagram: &Diagram, sites: &Sites| match reference::dualize(diagram, sites).unwrap_err() {
        DualizeError::Mismatch { index, .. } => index,
        other => panic!("{other}"),
    };
    assert_eq!(index(&grid(&["AAA.BB"], &[]).0, &sites), 3);
    assert_eq!(index(&grid(&["AAABBC"], &[]).0, &sites), 5);
    assert_eq!(index(&Diagram { width: 5, ..good.clone() }, &sites), 6);
    assert_eq!(index(&good, &Sites { count: 3, ..sites }), 3);
}

#[test]
fn what_does_not_fit_a_mesh_is_refused() {
    let mesh = polder_flip::reference::chain(&[0, 1, 2]);
    let line = [0.0, 1.0, 2.0, 3.0].map(|x| DVec2::new(x, x));
    let index = |result: Result<(), DualizeError>| match result.unwrap_err() {
        DualizeError::Mismatch { index, .. } => index,
        other => panic!("{other}"),
    };
    assert_eq!(index(reference::shift(mesh.clone(), &line, &line[..2]).map(drop)), 2);
    assert_eq!(index(reference::shift(mesh.clone(), &line[..2], &line).map(drop)), 1);
    let new = |points: &[u32], starts: &[u32], slots: &[[u32; 2]]| ToInsert {
        points: points.to_vec(),
        starts: starts.to_vec(),
        slots: slots.to_vec(),
    };
    assert_eq!(index(reference::insert(mesh.clone(), &line[..2], &ToInsert::default()).map(drop)), 1);
    assert_eq!(index(reference::insert(mesh.clone(), &line, &new(&[3, 4], &[0, 0], &[[4, 5], [6, 7]])).map(drop)), 1);
    for slots in [[3, 4], [4, 4], [5, 8], [NONE; 2]] {
        assert_eq!(index(reference::insert(mesh.clone(), &line, &new(&[3], &[0], &[slots])).map(drop)), 0);
    }
    assert_eq!(
        index(reference::insert(GhostMesh::default(), &line[..2], &new(&[0, 1], &[0; 2], &[[NONE; 2]; 2])).map(drop)),
        1
    );
    assert_eq!(index(reference::insert(mesh, &line, &new(&[3], &[], &[])).map(drop)), 0);
}

/// A mesh that is no triangulation: walks do not find what they look for, or the certificate fails.
#[test]
fn inserting_into_a_mesh_that_overlaps_ends_with_an_error() {
    let at: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i % 3), f64::from(i / 3))).collect();
    let (mut mesh, _) = polder_flip::reference::sweep(&at).unwrap();
    polder_flip::reference::flip(&mut mesh, &at).unwrap();
    let mut positions: Vec<DVec2> = (0..9).map(|i| at[i * 2 % 9]).collect();
    positions.push(DVec2::new(1.2, 0.7));
    let new = ToInsert::into_free_slots(&mesh, vec![9], vec![NONE]);
    let error = reference::insert(mesh, &positions, &new).unwrap_err();
    let known = matches!(error, DualizeError::WalkLost { .. } | DualizeError::NotCounterclockwise { .. });
    assert!(known, "{error}");
}

#[test]
fn errors_of_stage_1_come_through() {
    let options = Options::default();
    let error = reference::triangulate(&[], &options).unwrap_err();
    assert_eq!(error, DualizeError::Voronoi(VoronoiError::NoPoints));
    let error = reference::triangulate(&[DVec2::ZERO, DVec2::new(0.0, f64::NAN)], &options).unwrap_err();
    assert_eq!(error.to_string(), "point 1: its y coordinate is not a finite number");
    assert_eq!(reference::insert(GhostMesh::default(), &[], &ToInsert::default()).unwrap().mesh.slots(), 0);
}
