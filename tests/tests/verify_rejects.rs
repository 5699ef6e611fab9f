//! The checker rejects what is wrong, and says what and where.
#![allow(clippy::unwrap_used, reason = "tests")]

mod verify_support;

use polder::verify::{self, Kind, LISTED, Place, Verdict};
use polder_mesh::{Pslg, Triangulation};
use polder_tests::canonical_triangles;
use verify_support::{by_spade, pslg};

/// A mesh in canonical order, of points without ties, and where its insides are.
fn sample() -> (Pslg, Vec<[u32; 3]>) {
    let pslg = polder_io::generate::segments(500, 40, 1);
    let triangles = canonical_triangles(&pslg, &by_spade(&pslg).unwrap());
    assert!(verify::check(&pslg, &triangles).is_canonical());
    (pslg, triangles)
}

fn has(verdict: &Verdict, kind: Kind, place: Place) -> bool {
    !verdict.is_canonical() && verdict.problems().iter().any(|p| p.kind == kind && p.place == place)
}

fn assert_has(verdict: &Verdict, kind: Kind, place: Place) {
    assert!(has(verdict, kind, place), "no {kind:?} at {place} in: {verdict}");
    assert_eq!(verdict.is_valid(), verdict.totals().iter().all(|total| total.0.is_harmless()));
}

fn only(verdict: &Verdict, kind: Kind, place: Place) {
    assert_has(verdict, kind, place);
    assert_eq!(verdict.totals(), [(kind, 1)], "{verdict}");
}

/// Two triangles that share an edge strictly inside: their indices, and the edge's ends and apexes.
fn pairs(triangles: &[[u32; 3]]) -> impl Iterator<Item = ([usize; 2], [u32; 4])> {
    let mesh =
        Triangulation::from_triangles(1 + *triangles.iter().flatten().max().unwrap() as usize, triangles).unwrap();
    let all: Vec<_> = mesh
        .edges()
        .filter_map(|edge| {
            let twin = mesh.twin(edge.id)?;
            let apex = |e: polder_mesh::EdgeId| mesh.triangles()[e.triangle().index()][e.k()];
            let [b, c] = edge.vertices.map(|v| v.0);
            Some(([edge.id.triangle().index(), twin.triangle().index()], [apex(edge.id), b, c, apex(twin)]))
        })
        .collect();
    all.into_iter()
}

fn on_hull(triangles: &[[u32; 3]]) -> Vec<bool> {
    let mesh = Triangulation::from_triangles(500, triangles).unwrap();
    let mut on = vec![false; 500];
    mesh.hull().iter().for_each(|v| on[v.index()] = true);
    on
}

#[test]
fn a_flipped_edge() {
    let (pslg, triangles) = sample();
    let is_constraint = |a: u32, d: u32| pslg.constraints().iter().any(|c| *c == [a, d] || *c == [d, a]);
    let mut tried = 0;
    for ([t, u], [a, b, c, d]) in pairs(&triangles) {
        let mut other = triangles.clone();
        (other[t], other[u]) = ([a, b, d], [a, d, c]);
        let verdict = verify::check(&pslg, &other);
        if verdict.total(Kind::Clockwise) > 0 || verdict.total(Kind::Flat) > 0 || is_constraint(b, c) {
            // The other diagonal lies outside the two triangles, or the one that is gone was a constraint.
            assert!(!verdict.is_valid());
            continue;
        }
        tried += 1;
        let (lower, upper) = if a < d { (a, d) } else { (d, a) };
        let at = if a < d { u } else { t } as u32;
        assert_has(&verdict, Kind::NotDelaunay, Place::Edge { ends: [lower, upper], triangle: at });
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn the_other_diagonal_of_a_tie_is_valid_but_not_canonical() {
    let pslg = pslg(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[]);
    assert!(verify::check(&pslg, &[[0, 1, 2], [0, 2, 3]]).is_canonical());
    let verdict = verify::check(&pslg, &[[0, 1, 3], [1, 2, 3]]);
    assert!(verdict.is_valid());
    only(&verdict, Kind::OtherDiagonal, Place::Edge { ends: [1, 3], triangle: 0 });
}

#[test]
fn a_constrained_edge_need_not_be_delaunay() {
    let points = [(0.0, 0.0), (4.0, -1.0), (8.0, 0.0), (4.0, 1.0)];
    let long = [[0, 1, 2], [0, 2, 3]];
    only(&verify::check(&pslg(&points, &[]), &long), Kind::NotDelaunay, Place::Edge { ends: [0, 2], triangle: 1 });
    assert!(verify::check(&pslg(&points, &[[2, 0]]), &long).is_canonical());
}

#[test]
fn a_missing_triangle() {
    let (pslg, triangles) = sample();
    let hull = on_hull(&triangles);
    let (mut holes, mut notches) = (0, 0);
    for t in 0..triangles.len() {
        let mut fewer = triangles.clone();
        let [a, b, c] = fewer.remove(t);
        let verdict = verify::check(&pslg, &fewer);
        assert!(!verdict.is_valid());
        match [a, b, c].iter().filter(|&&v| hull[v as usize]).count() {
            0 => {
                let place = verdict.problems().iter().find(|p| p.kind == Kind::Hole).unwrap().place;
                let Place::Edge { ends, .. } = place else { panic!("{place}") };
                assert!(ends.iter().all(|v| [a, b, c].contains(v)), "{place} of {a} {b} {c}");
                assert_eq!(verdict.total(Kind::Hole), 1);
                holes += 1;
            }
            2 => {
                let apex = [a, b, c].into_iter().find(|&v| !hull[v as usize]).unwrap();
                if has(&verdict, Kind::Notch, Place::Point(apex)) {
                    notches += 1;
                }
            }
            _ => {}
        }
    }
    assert!(holes > 800 && notches >= 10, "{holes} {notches}");
}

#[test]
fn a_notch_in_the_hull() {
    // Delaunay in every edge, and all points are used.
    let pslg = pslg(&[(0.0, 0.0), (4.0, 0.0), (2.0, 1.0), (2.0, 5.0)], &[]);
    only(&verify::check(&pslg, &[[0, 2, 3], [1, 3, 2]]), Kind::Notch, Place::Point(2));
    assert!(verify::check(&pslg, &[[0, 1, 2], [0, 2, 3], [1, 3, 2]]).is_canonical());
}

#[test]
fn a_missing_constraint() {
    let points = [(0.0, 0.0), (4.0, -1.0), (8.0, 0.0), (4.0, 1.0)];
    let verdict = verify::check(&pslg(&points, &[[0, 1], [0, 2]]), &[[0, 1, 3], [1, 2, 3]]);
    only(&verdict, Kind::MissingConstraint, Place::Constraint { constraint: 1, vertex: 0 });

    // It breaks off in the middle: 0-4 is there, 4-2 is not.
    let points = [(0.0, 0.0), (4.0, -1.0), (8.0, 0.0), (4.0, 1.0), (1.0, 0.0), (6.0, 0.5)];
    let broken = pslg(&points, &[[0, 2]]);
    let triangles = canonical_triangles(&broken, &by_spade(&pslg(&points, &[])).unwrap());
    let verdict = verify::check(&broken, &triangles);
    only(&verdict, Kind::MissingConstraint, Place::Constraint { constraint: 0, vertex: 4 });
}

#[test]
fn a_swapped_orientation() {
    let (pslg, mut triangles) = sample();
    for t in [0, 77, 900] {
        triangles[t].swap(1, 2);
        let verdict = verify::check(&pslg, &triangles);
        assert_has(&verdict, Kind::Clockwise, Place::Triangle(t as u32));
        assert_eq!(verdict.total(Kind::Clockwise), 1);
        triangles[t].swap(1, 2);
    }
    triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let verdict = verify::check(&pslg, &triangles);
    assert_has(&verdict, Kind::WhollyClockwise, Place::Mesh);
    assert_eq!(verdict.total(Kind::Clockwise), 0);
    assert_eq!(verdict.total(Kind::NotDelaunay), 0);
}

#[test]
fn a_duplicated_triangle() {
    let (pslg, mut triangles) = sample();
    let [a, b, c] = triangles[33];
    triangles.push([b, c, a]);
    let verdict = verify::check(&pslg, &triangles);
    assert_has(&verdict, Kind::RepeatedTriangle, Place::Triangles([33, triangles.len() as u32 - 1]));
    assert_eq!(verdict.total(Kind::CrowdedEdge), 0, "reported once, and left out then: {verdict}");
}

#[test]
fn an_edge_with_two_triangles_on_one_side() {
    let pslg = pslg(&[(0.0, 0.0), (4.0, 0.0), (0.0, 4.0), (4.0, 4.0)], &[]);
    let verdict = verify::check(&pslg, &[[0, 1, 2], [0, 1, 3]]);
    assert_has(&verdict, Kind::CrowdedEdge, Place::Edge { ends: [0, 1], triangle: 1 });
}

#[test]
fn an_unused_point() {
    let (pslg, triangles) = sample();
    let mut points = pslg.points().to_vec();
    points.push(points[3].midpoint(points[4]));
    let more = Pslg::new(points, pslg.constraints().to_vec()).unwrap();
    only(&verify::check(&more, &triangles), Kind::UnusedPoint, Place::Point(500));
}

#[test]
fn a_point_under_two_names() {
    let pslg = pslg(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 3.0), (0.0, 0.0)], &[]);
    let triangles = [[0, 1, 3], [1, 2, 3]];
    assert!(verify::check(&pslg, &triangles).is_valid());
    let one_more = Pslg::new([pslg.points(), &[(1.0, 1.0).into()]].concat(), vec![]).unwrap();
    let verdict = verify::check(&one_more, &[[0, 1, 5], [1, 2, 5], [2, 3, 5], [3, 4, 5]]);
    only_error(&verdict, Kind::TwoNames, Place::Point(0));
}

fn only_error(verdict: &Verdict, kind: Kind, place: Place) {
    assert_has(verdict, kind, place);
    let errors = verdict.totals().iter().filter(|total| !total.0.is_harmless());
    assert!(errors.eq([&(kind, 1)]), "{verdict}");
}

#[test]
fn an_index_out_of_range() {
    let (pslg, mut triangles) = sample();
    triangles[12][1] = 500;
    assert_has(&verify::check(&pslg, &triangles), Kind::OutOfRange, Place::Triangle(12));
    triangles[12][1] = u32::MAX;
    assert_has(&verify::check(&pslg, &triangles), Kind::OutOfRange, Place::Triangle(12));
}

#[test]
fn a_flat_triangle_and_a_repeated_corner() {
    let pslg = pslg(&[(0.0, 0.0), (4.0, 0.0), (0.0, 4.0), (2.0, 2.0)], &[]);
    let verdict = verify::check(&pslg, &[[0, 1, 2], [1, 3, 2]]);
    assert_has(&verdict, Kind::Flat, Place::Triangle(1));
    let verdict = verify::check(&pslg, &[[0, 1, 3], [0, 3, 2], [2, 3, 3]]);
    assert_has(&verdict, Kind::RepeatedCorner, Place::Triangle(2));
}

#[test]
fn a_vertex_in_the_middle_of_an_edge() {
    // Above, one triangle has the whole edge 4-5; below, two have its halves 4-6 and 6-5.
    let points = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0), (-2.0, 0.0), (2.0, 0.0), (0.0, 0.0)];
    let triangles = [[0, 1, 6], [0, 4, 3], [0, 6, 4], [1, 2, 5], [1, 5, 6], [2, 3, 4], [2, 4, 5]];
    let verdict = verify::check(&pslg(&points, &[]), &triangles);
    let errors: Vec<_> = verdict.problems().iter().filter(|p| !p.kind.is_harmless()).collect();
    assert_eq!(errors.len(), 1, "{verdict}");
    assert_eq!(errors[0].kind, Kind::Hole);
    assert_eq!(errors[0].place, Place::Edge { ends: [6, 4], triangle: 2 });
}

#[test]
fn a_cover_that_winds_twice() {
    // A pentagram's five points around a middle: each triangle joins the middle to a point and the next but one. Each
    // is counterclockwise, each edge has its two triangles, the hull turns left everywhere, every point is used.
    let points = [(0.0, 0.0), (10.0, 0.0), (3.0, 9.5), (-8.0, 6.0), (-8.0, -6.0), (3.0, -9.5)];
    let triangles = [[0, 1, 3], [0, 2, 4], [0, 3, 5], [0, 4, 1], [0, 5, 2]];
    let pslg = pslg(&points, &[[0, 1], [0, 2], [0, 3], [0, 4], [0, 5]]);
    let verdict = verify::check(&pslg, &triangles);
    assert_eq!(verdict.totals(), [(Kind::WindsTwice, 1)], "{verdict}");
}

#[test]
fn pieces_and_pinched_vertices() {
    let points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (5.0, 5.0), (6.0, 5.0), (5.0, 6.0)];
    let apart = verify::check(&pslg(&points, &[]), &[[0, 1, 2], [3, 4, 5]]);
    assert_eq!(apart.totals(), [(Kind::Pieces, 1)]);

    let points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    let pinched = verify::check(&pslg(&points, &[]), &[[0, 1, 2], [0, 3, 4]]);
    assert_has(&pinched, Kind::PinchedVertex, Place::Point(0));
}

#[test]
fn nothing_where_something_should_be() {
    let verdict = verify::check(&pslg(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)], &[]), &[]);
    only(&verdict, Kind::Empty, Place::Mesh);
}

#[test]
fn another_order_is_valid_but_not_canonical() {
    let (pslg, triangles) = sample();
    let mut turned = triangles.clone();
    turned[5].rotate_left(1);
    let verdict = verify::check(&pslg, &turned);
    assert!(verdict.is_valid());
    assert_has(&verdict, Kind::NotSmallestFirst, Place::Triangle(5));

    let mut swapped = triangles;
    swapped.swap(8, 9);
    let verdict = verify::check(&pslg, &swapped);
    assert!(verdict.is_valid());
    only(&verdict, Kind::NotSorted, Place::Triangle(9));
}

#[test]
fn many_problems_are_counted_and_some_listed() {
    let (pslg, mut triangles) = sample();
    let n = triangles.len();
    triangles[100..].iter_mut().for_each(|t| t[0] = 1000);
    let verdict = verify::check(&pslg, &triangles);
    assert_eq!(verdict.total(Kind::OutOfRange), n as u64 - 100);
    let listed: Vec<_> = verdict.problems().iter().filter(|p| p.kind == Kind::OutOfRange).collect();
    assert_eq!(listed.len(), LISTED);
    assert_eq!(listed[0].place, Place::Triangle(100));
    let text = verdict.to_string();
    assert!(text.starts_with("not valid: "), "{text}");
    assert!(text.contains("\n  triangle 100: a corner is no point of the input\n"), "{text}");
    assert!(text.contains(&format!("\n  and {} more like this\n", n - 100 - LISTED)), "{text}");
}
