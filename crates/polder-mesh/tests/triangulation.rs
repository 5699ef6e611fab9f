//! Canonical order, neighbors, iterators and digest on meshes small enough to see through.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_mesh::{
    Chains, DVec2, EdgeId, GHOST, GhostMesh, MeshError, NONE, Parts, Pslg, TriangleId, Triangulation, VertexId,
};
use proptest::prelude::*;

/// A grid of `w` times `h` squares, each cut by a diagonal; vertices row by row, `w + 1` in each.
fn grid(w: u32, h: u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for y in 0..h {
        for x in 0..w {
            let a = y * (w + 1) + x;
            let (b, c, d) = (a + 1, a + w + 2, a + w + 1);
            triangles.extend([[a, b, c], [c, d, a]]);
        }
    }
    triangles
}

fn points(w: u32, h: u32) -> usize {
    ((w + 1) * (h + 1)) as usize
}

#[test]
fn triangles_start_at_their_smallest_corner_and_are_sorted() {
    let mesh = Triangulation::from_triangles(4, &[[3, 2, 1], [1, 0, 3]]).unwrap();
    assert_eq!(mesh.triangles(), [[0, 3, 1], [1, 3, 2]]);
    assert_eq!(mesh.neighbors(), [[1, NONE, NONE], [NONE, NONE, 0]]);
    insta::assert_snapshot!(mesh, @r"
    0: 0 3 1 | 1 - -
    1: 1 3 2 | - - 0
    ");
}

#[test]
fn what_is_in_canonical_order_already_is_taken_as_it_is() {
    let parts = || Parts { representatives: (0..4).collect(), chains: Chains::default() };
    let make = |triangles: &[[u32; 3]], neighbors: &[[u32; 3]], constrained: &[u8]| {
        Triangulation::from_canonical(triangles.to_vec(), neighbors.to_vec(), constrained.to_vec(), parts())
    };
    let (triangles, neighbors) = ([[0, 3, 1], [1, 3, 2]], [[1, NONE, NONE], [NONE, NONE, 0]]);
    let mesh = make(&triangles, &neighbors, &[1, 4]).unwrap();
    assert_eq!(
        (mesh.triangles(), mesh.neighbors(), mesh.constrained_bits()),
        (&triangles[..], &neighbors[..], &[1, 4][..])
    );
    assert!(make(&[], &[], &[]).is_ok());

    let fault = |triangles: &[[u32; 3]], neighbors: &[[u32; 3]], constrained: &[u8]| match make(
        triangles,
        neighbors,
        constrained,
    ) {
        Err(MeshError::Broken { triangle, .. }) => triangle,
        other => panic!("{other:?}"),
    };
    assert_eq!(fault(&triangles, &neighbors[..1], &[0, 0]), 1);
    assert_eq!(fault(&triangles, &neighbors, &[0]), 1);
    assert_eq!(fault(&[[0, 4, 1], [1, 3, 2]], &neighbors, &[0, 0]), 0);
    assert_eq!(fault(&[[0, 3, 1], [3, 2, 1]], &neighbors, &[0, 0]), 1);
    assert_eq!(fault(&[[0, 3, 1], [0, 3, 1]], &neighbors, &[0, 0]), 1);
    assert_eq!(fault(&[[0, 3, 1], [0, 1, 3]], &neighbors, &[0, 0]), 1);
    assert_eq!(fault(&triangles, &[[1, NONE, 2], [NONE, NONE, 0]], &[0, 0]), 0);

    // Long enough to be checked in pieces, with a fault at every place of some.
    let long: Vec<[u32; 3]> = (0..70_000).flat_map(|t| [[t, t + 1, t + 2], [t, t + 2, t + 3]]).collect();
    let count = long.len() as u32;
    let make = |triangles: &[[u32; 3]], at: usize, neighbor: u32| {
        let mut neighbors = vec![[NONE, 0, count - 1]; count as usize];
        neighbors[at][1] = neighbor;
        let parts = Parts { representatives: (0..70_003).collect(), chains: Chains::default() };
        Triangulation::from_canonical(triangles.to_vec(), neighbors, vec![0; count as usize], parts)
    };
    assert!(make(&long, 7, NONE).is_ok());
    let broken = |result| matches!(result, Err(MeshError::Broken { triangle, .. }) if triangle == 65536);
    assert!(broken(make(&long, 65536, count)));
    for wrong in [[32767, 32769, 32770], [32768, 32769, 32768], [32768, 32768, 32769], [32768, 32769, 70_003]] {
        let mut triangles = long.clone();
        triangles[65536] = wrong;
        assert!(broken(make(&triangles, 0, 0)), "{wrong:?}");
    }
}

#[test]
fn the_digest_is_the_documented_hash() {
    // printf 'polder mesh v1\n\0' followed by the count and the corners, through sha256sum.
    let empty = Triangulation::from_triangles(0, &[]).unwrap();
    let one = Triangulation::from_triangles(3, &[[1, 2, 0]]).unwrap();
    insta::assert_snapshot!(format!("{}\n{}", empty.digest(), one.digest()));
}

#[test]
fn iterators_of_a_grid() {
    let mesh = Triangulation::from_triangles(points(3, 2), &grid(3, 2)).unwrap();
    let hull: Vec<u32> = mesh.hull().into_iter().map(|v| v.0).collect();
    assert_eq!(hull, [0, 1, 2, 3, 7, 11, 10, 9, 8, 4]);
    assert_eq!(mesh.vertices().count(), 12);
}

#[test]
fn the_star_of_a_vertex_goes_round_counterclockwise() {
    let mesh = Triangulation::from_triangles(points(2, 2), &grid(2, 2)).unwrap();
    for v in 0..9 {
        let star = mesh.star(VertexId(v));
        assert_eq!(star.len(), mesh.triangles().iter().filter(|t| t.contains(&v)).count());
        for pair in star.windows(2) {
            // The edge from v that the first triangle ends with is the one that the second one begins with.
            let corner = |t: TriangleId| mesh.triangles()[t.index()].iter().position(|&c| c == v).unwrap();
            let (last, first) = (corner(pair[0]), corner(pair[1]));
            let (last, first) = (EdgeId::of(pair[0], (last + 1) % 3), EdgeId::of(pair[1], (first + 2) % 3));
            assert_eq!(mesh.twin(last), Some(first));
        }
    }
    assert!(mesh.star(VertexId(9)).is_empty());
}

#[test]
fn every_interior_edge_comes_once_and_hull_edges_too() {
    let (w, h) = (5, 4);
    let mesh = Triangulation::from_triangles(points(w, h), &grid(w, h)).unwrap();
    let mut edges: Vec<_> = mesh.edges().map(|e| e.vertices.map(|v| v.0)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    let before = edges.len();
    edges.dedup();
    assert_eq!(edges.len(), before, "an edge came twice");
    // Euler: V - E + F = 1 for a disk.
    assert_eq!(points(w, h) + mesh.triangles().len(), edges.len() + 1);
}

#[test]
fn broken_triangles_are_named() {
    let broken = |points, triangles: &[[u32; 3]]| match Triangulation::from_triangles(points, triangles) {
        Err(MeshError::Broken { triangle, what }) => (triangle, what),
        other => panic!("{other:?}"),
    };
    assert_eq!(broken(3, &[[0, 1, 2], [1, 2, 3]]), (1, "a corner that is no point"));
    assert_eq!(broken(3, &[[0, 1, 1]]), (0, "a vertex twice"));
    assert_eq!(broken(4, &[[0, 1, 2], [0, 1, 3]]), (1, "an edge with two triangles on one side"));
}

#[test]
fn a_pslg_names_what_is_wrong() {
    let at = DVec2::new;
    let good = vec![at(0.0, -0.0), at(1.0, 5e-324), at(f64::MAX, f64::MIN)];
    assert!(Pslg::new(good.clone(), vec![[0, 2], [2, 2], [0, 2]]).is_ok());
    let bad = vec![at(0.0, 0.0), at(1.0, f64::INFINITY), at(f64::NAN, 0.0)];
    assert_eq!(Pslg::new(bad, vec![]), Err(MeshError::NonFiniteCoordinate { point: 1, axis: 'y' }));
    let error = Pslg::new(good, vec![[0, 1], [3, 0]]).unwrap_err();
    assert_eq!(error.to_string(), "constraint 1: it names point 3, but there are only 3 points");
}

#[test]
fn zero_length_constraints_are_kept_and_found() {
    let points = vec![DVec2::new(0.0, 0.0), DVec2::new(-0.0, 0.0), DVec2::new(1.0, 0.0)];
    let pslg = Pslg::new(points, vec![[0, 2], [0, 1], [2, 2]]).unwrap();
    assert_eq!(pslg.zero_length_constraints().map(|c| c.0).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(pslg.constraints().len(), 3);
}

/// Two triangles with their ghosts around them.
fn square() -> GhostMesh {
    let mut mesh = GhostMesh::with_slots(6);
    mesh.triangles = vec![[0, 1, 2], [0, 2, 3], [1, 0, GHOST], [2, 1, GHOST], [3, 2, GHOST], [0, 3, GHOST]];
    for (g, h) in [(1, 5), (2, 8), (0, 11), (3, 14), (4, 17), (7, 9), (10, 12), (13, 15), (16, 6)] {
        mesh.link(g, h);
    }
    mesh
}

#[test]
fn a_flip_keeps_links_and_marks() {
    let mut mesh = square();
    mesh.check().unwrap();
    mesh.set_constrained(2, true);
    let new = mesh.flip(1);
    mesh.check().unwrap();
    assert_eq!([mesh.origin(new), mesh.destination(new)], [3, 1]);
    let marked: Vec<_> =
        (0..18).filter(|&h| mesh.is_constrained(h)).map(|h| [mesh.origin(h), mesh.destination(h)]).collect();
    assert_eq!(marked, [[0, 1], [1, 0]]);
    insta::assert_snapshot!(mesh);
}

#[test]
fn checks_find_a_mutation_anywhere() {
    let whole = square();
    for t in 0..6 {
        for k in 0..3 {
            let mut corner = whole.clone();
            corner.triangles[t][k] = 7;
            assert!(corner.check().is_err(), "corner {k} of {t}");
            let mut link = whole.clone();
            link.links[t][k] = (link.links[t][k] + 1) % 18;
            assert!(link.check().is_err(), "link {k} of {t}");
            let mut mark = whole.clone();
            mark.constrained[t] ^= 1 << k;
            assert!(mark.check().is_err(), "mark {k} of {t}");
        }
    }
}

#[test]
fn compacting_keeps_the_mesh() {
    let mut mesh = GhostMesh::with_slots(2);
    let part = square();
    mesh.triangles.extend(&part.triangles);
    mesh.links.extend(part.links.iter().map(|l| l.map(|h| h + 6)));
    mesh.constrained.extend(&part.constrained);
    mesh.check().unwrap();
    mesh.compact();
    assert_eq!(mesh, part);
}

proptest! {
    #[test]
    fn canonical_whatever_the_slots_and_turns(
        (w, h) in (1u32..30, 1u32..30),
        order in any::<u64>(),
    ) {
        let n = points(w, h);
        let sorted = Triangulation::from_triangles(n, &grid(w, h)).unwrap();
        // Shuffle the slots and turn the corners by a linear congruence.
        let mut mixed = grid(w, h);
        let mut state = order | 1;
        for i in (1..mixed.len()).rev() {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            mixed.swap(i, (state >> 33) as usize % (i + 1));
            mixed[i].rotate_left((state >> 20) as usize % 3);
        }
        let again = Triangulation::from_triangles(n, &mixed).unwrap();
        prop_assert_eq!(&sorted, &again);
        prop_assert_eq!(sorted.neighbors(), again.neighbors());
        prop_assert_eq!(sorted.digest(), again.digest());
        prop_assert!(sorted.triangles().is_sorted());
        for e in (0..3 * sorted.triangles().len() as u32).map(EdgeId) {
            if let Some(twin) = sorted.twin(e) {
                prop_assert_eq!(sorted.twin(twin), Some(e));
                let [a, b] = sorted.ends(e);
                prop_assert_eq!(sorted.ends(twin), [b, a]);
            }
        }
        // Another mesh has another digest.
        let mut fewer = mixed;
        fewer.pop();
        prop_assert_ne!(Triangulation::from_triangles(n, &fewer).unwrap().digest(), sorted.digest());
    }
}

#[test]
fn many_vertices_in_many_parts() {
    // Past the size at which the canonical order works in several parts, with renamed vertices and free slots.
    let (w, h) = (300, 200);
    let n = points(w, h);
    let names: Vec<u32> = (0..n as u32).map(|v| v * 7919 % n as u32).collect();
    let triangles: Vec<_> = grid(w, h).into_iter().map(|t| t.map(|v| names[v as usize])).collect();
    let sorted = Triangulation::from_triangles(n, &triangles).unwrap();
    let mut expected = triangles;
    for t in &mut expected {
        let smallest = (0..3).min_by_key(|&k| t[k]).unwrap();
        t.rotate_left(smallest);
    }
    expected.sort_unstable();
    assert_eq!(sorted.triangles(), expected);
}

#[test]
fn duplicates_and_chains_have_a_text_form() {
    let mut chains = Chains::default();
    chains.push([0, 1]);
    chains.push([2]);
    let parts = Parts { representatives: vec![0, 1, 2, 1], chains };
    let mut mesh = GhostMesh::with_slots(1);
    mesh.triangles[0] = [0, 1, 2];
    mesh.constrained[0] = 0b100;
    let mesh = Triangulation::from_mesh(&mesh, &[0, 1, 2], parts);
    assert_eq!(mesh.duplicates().collect::<Vec<_>>(), [(3, VertexId(1))]);
    assert_eq!(mesh.vertices().count(), 3);
    insta::assert_snapshot!(mesh, @r"
    0: 0 1 2 | - - !-
    point 3 = 1
    constraint 0: 0 1
    constraint 1: 2
    ");
}
