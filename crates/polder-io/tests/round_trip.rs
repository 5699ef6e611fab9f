//! What is written reads back the same.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_io::*;
use polder_mesh::{Chains, DVec2, Parts, Pslg, Triangulation};
use proptest::prelude::*;

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |x| x.is_finite()),
        (-20i32..20).prop_map(f64::from),
        Just(-0.0),
        Just(5e-324),
        Just(f64::MAX),
        Just(0.1 + 0.2),
    ]
}

fn point() -> impl Strategy<Value = DVec2> {
    (coordinate(), coordinate()).prop_map(DVec2::from)
}

prop_compose! {
    fn pslg()(points in prop::collection::vec(point(), 0..40))
        (ends in prop::collection::vec([0..points.len().max(1) as u32, 0..points.len().max(1) as u32], 0..30), points in Just(points))
        -> Pslg
    {
        let constraints = if points.is_empty() { Vec::new() } else { ends };
        Pslg::new(points, constraints).unwrap()
    }
}

prop_compose! {
    fn input()(pslg in pslg(), first in 0u32..2, per_point in 0usize..3, point_marks in any::<bool>(), marks in any::<bool>())
        (attributes in prop::collection::vec(coordinate(), per_point * pslg.points().len()),
         point_markers in prop::collection::vec(any::<i64>(), pslg.points().len()),
         constraint_markers in prop::collection::vec(any::<i64>(), pslg.constraints().len()),
         holes in prop::collection::vec(point(), 0..3),
         regions in prop::collection::vec((point(), coordinate(), prop::option::of(coordinate())), 0..3),
         pslg in Just(pslg), first in Just(first), per_point in Just(per_point),
         point_marks in Just(point_marks), marks in Just(marks))
        -> Input
    {
        Input {
            first: if pslg.points().is_empty() { 1 } else { first },
            pslg,
            attributes_per_point: per_point,
            attributes,
            point_markers: point_marks.then_some(point_markers),
            constraint_markers: marks.then_some(constraint_markers),
            holes,
            regions: regions
                .into_iter()
                .map(|(point, attribute, max_area)| Region { point, attribute, max_area })
                .collect(),
        }
    }
}

fn written(write: impl Fn(&mut dyn std::io::Write) -> std::io::Result<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).unwrap();
    bytes
}

/// Equality also of the signs of zeros.
fn same_bits(a: &[DVec2], b: &[DVec2]) -> bool {
    let bits = |p: &[DVec2]| p.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect::<Vec<_>>();
    bits(a) == bits(b)
}

proptest! {
    #[test]
    fn poly(input in input()) {
        let bytes = written(|out| write_poly(out, &input));
        let back = Input::read_from(Source::bytes(bytes, "x"), InputFormat::Poly).unwrap();
        prop_assert!(same_bits(back.pslg.points(), input.pslg.points()));
        prop_assert_eq!(back, input);
    }

    #[test]
    fn node(input in input()) {
        let bytes = written(|out| write_node(out, &input));
        let back = Input::read_from(Source::bytes(bytes, "x"), InputFormat::Node).unwrap();
        let (points, _) = input.pslg.into_parts();
        prop_assert!(same_bits(back.pslg.points(), &points));
        let expected =
            Input { pslg: Pslg::new(points, vec![]).unwrap(), constraint_markers: None, holes: vec![], regions: vec![], ..input };
        prop_assert_eq!(back, expected);
    }

    #[test]
    fn raw_pslg(pslg in pslg()) {
        let bytes = written(|out| write_pslg(out, &pslg));
        prop_assert_eq!(bytes.len(), 16 + 16 * pslg.points().len() + 8 * pslg.constraints().len());
        let back = Input::read_from(Source::bytes(bytes, "x"), InputFormat::Pslg).unwrap();
        prop_assert!(same_bits(back.pslg.points(), pslg.points()));
        prop_assert_eq!(back.pslg, pslg);
    }

    #[test]
    fn meshes(points in prop::collection::vec(point(), 3..20), first in 0u32..2, seed: u64) {
        let n = points.len() as u32;
        // A fan is a mesh as far as formats care.
        let triangles: Vec<_> = (1..n - 1).map(|i| if seed >> (i % 64) & 1 == 1 { [0, i, i + 1] } else { [i, i + 1, 0] }).collect();
        let mesh = Triangulation::from_triangles(points.len(), &triangles).unwrap();
        let expected = mesh.triangles().to_vec();
        let read = |format, bytes| MeshFile::read_from(Source::bytes(bytes, "x"), format).unwrap();

        let ele = read(MeshFormat::Ele, written(|out| write_ele(out, &mesh, first)));
        prop_assert_eq!(ele, MeshFile { triangles: expected.clone(), vertices: None, first });
        let tri = read(MeshFormat::Tri, written(|out| write_tri(out, mesh.triangles())));
        prop_assert_eq!(tri, MeshFile { triangles: expected.clone(), vertices: None, first: 0 });
        for (format, bytes) in [
            (MeshFormat::Obj, written(|out| write_obj(out, &points, &mesh))),
            (MeshFormat::Ply, written(|out| write_ply(out, &points, &mesh))),
            (MeshFormat::Vtk, written(|out| write_vtk(out, &points, &mesh))),
        ] {
            let back = read(format, bytes);
            prop_assert!(same_bits(back.vertices.as_ref().unwrap(), &points));
            prop_assert_eq!(&back.triangles, &expected);
        }
    }
}

/// A square with a center and one constrained side, and a repeated point.
fn square() -> (Input, Triangulation) {
    let points = [(0, 0), (4, 0), (4, 4), (0, 4), (2, 2), (4, 4)].map(|(x, y)| DVec2::new(x.into(), y.into()));
    let pslg = Pslg::new(points.to_vec(), vec![[0, 1], [4, 2]]).unwrap();
    let mut chains = Chains::with_capacity(2);
    chains.push([0, 1]);
    chains.push([4, 2]);
    let slots = [
        (polder_mesh::Slot { corners: [0, 1, 4], neighbors: [1, 3, u32::MAX], constrained: 0b100 }),
        (polder_mesh::Slot { corners: [1, 2, 4], neighbors: [2, 0, u32::MAX], constrained: 0b001 }),
        (polder_mesh::Slot { corners: [2, 3, 4], neighbors: [3, 1, u32::MAX], constrained: 0b010 }),
        (polder_mesh::Slot { corners: [3, 0, 4], neighbors: [0, 2, u32::MAX], constrained: 0 }),
    ];
    let parts = Parts { representatives: vec![0, 1, 2, 3, 4, 2], chains };
    let mesh = Triangulation::from_slots(4, |t| Some(slots[t]), parts);
    (Input { constraint_markers: Some(vec![7, 0]), ..Input::new(pslg, 1) }, mesh)
}

#[test]
fn text_formats_look_as_they_should() {
    let (input, mesh) = square();
    let points = input.pslg.points();
    let show = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let all = [
        (".poly", show(written(|out| write_poly(out, &input)))),
        (".ele", show(written(|out| write_ele(out, &mesh, 1)))),
        (".neigh", show(written(|out| write_neigh(out, &mesh, 1)))),
        (".edge", show(written(|out| write_edge(out, &mesh, &input)))),
        (".obj", show(written(|out| write_obj(out, points, &mesh)))),
        (".vtk", show(written(|out| write_vtk(out, points, &mesh)))),
        (".svg", show(written(|out| svg::write_svg(out, points, &mesh)))),
    ];
    insta::assert_snapshot!(all.map(|(name, text)| format!("--- {name}\n{text}")).concat());
}

#[test]
fn pictures_of_anything_have_finite_numbers() {
    let families = [
        generate::huge(50, 1),
        generate::tiny(50, 1),
        generate::subnormal(50, 1),
        generate::mixed_magnitudes(50, 1),
        generate::collinear(9, 1),
        generate::uniform(0, 1),
        generate::uniform(1, 1),
        Pslg::new(vec![DVec2::MAX, DVec2::MIN], vec![[0, 1]]).unwrap(),
    ];
    for pslg in families {
        let frame = svg::Frame::fit(pslg.points(), 1000.0, 20.0);
        assert!(frame.width < 1000.1 && frame.height < 1000.1 && frame.width.min(frame.height) > 100.0, "{frame:?}");
        for &p in pslg.points() {
            let q = frame.map(p);
            assert!(q.min_element() >= 19.9 && q.x <= frame.width - 19.9 && q.y <= frame.height - 19.9, "{p} {q}");
        }
    }
}

#[test]
fn vertices_of_other_tools_are_found_among_the_points() {
    let points = [(0., 0.), (1., 0.), (0., 1.), (1., 0.), (-0., 0.)].map(DVec2::from);
    let file = |vertices: &[(f64, f64)], triangles: &[[u32; 3]]| MeshFile {
        triangles: triangles.to_vec(),
        vertices: Some(vertices.iter().copied().map(DVec2::from).collect()),
        first: 0,
    };
    let mut same = file(&[(0., 0.), (1., 0.), (0., 1.), (1., 0.), (0., 0.)], &[[4, 3, 2]]);
    same.name_by_points(&points).unwrap();
    assert_eq!(same.triangles, [[4, 3, 2]]);
    let mut other = file(&[(0., 1.), (7., 7.), (1., 0.), (0., 0.)], &[[3, 2, 0]]);
    other.name_by_points(&points).unwrap();
    assert_eq!(other.triangles, [[0, 1, 2]]);
    let mut wrong = file(&[(0., 1.), (7., 7.), (1., 0.)], &[[0, 2, 1]]);
    assert_eq!(wrong.name_by_points(&points), Err(1));
}

#[test]
fn a_closed_outline_is_noticed() {
    let ends = |ends: &[[u32; 2]]| Input::new(Pslg::new(vec![DVec2::ZERO; 5], ends.to_vec()).unwrap(), 0);
    assert!(ends(&[[0, 1], [1, 2], [2, 0]]).has_holes_or_closed_outline());
    assert!(ends(&[[0, 1], [1, 2], [2, 0], [3, 3]]).has_holes_or_closed_outline());
    assert!(ends(&[[0, 1], [1, 2], [3, 4], [4, 1], [2, 0]]).has_holes_or_closed_outline());
    assert!(!ends(&[[0, 1], [1, 2], [1, 3], [3, 4], [4, 4]]).has_holes_or_closed_outline());
    assert!(!ends(&[]).has_holes_or_closed_outline());
    let hole = Input { holes: vec![DVec2::ZERO], ..ends(&[]) };
    assert!(hole.has_holes_or_closed_outline());
}
