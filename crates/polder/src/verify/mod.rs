//! An exact checker of any mesh of a planar straight-line graph, other tools' meshes included.
//!
//! [`check`] takes bare triangles, [`check_triangulation`] a [`Triangulation`] with its neighbors, constrained bits,
//! duplicates and chains. Both read everything and decide by exact predicates alone; the [`Verdict`] lists what is
//! wrong and where.
//!
//! # What is checked, in this order
//!
//! 1. every corner is a point, no triangle has a point twice, no triangle is flat, every one is counterclockwise (a
//!    mesh that is clockwise throughout is told so once, and read the other way round from there on);
//! 2. no triangle is there twice, no edge has two triangles on one side, the triangles around each vertex are one fan;
//! 3. every distinct point is a vertex, under one name: of equal points any one may serve;
//! 4. the edges with a triangle on one side alone form one closed line, which turns left or goes straight on
//!    everywhere and winds round once: the convex hull, without a notch and without a hole;
//! 5. every constraint is a chain of mesh edges from its first end to its second, each exactly on the segment;
//! 6. every other inner edge is locally Delaunay: the fourth corner is not inside the circle of the other three;
//! 7. whether the mesh is the canonical one: ties go to the diagonal at the lexicographically smallest of the four
//!    corners, of equal points the lowest index is used, triangles start at their smallest corner and are sorted.
//!
//! # Why this is enough
//!
//! *No two triangles overlap, and together they fill the convex hull.* Take a point `q` on no line through two
//! vertices. A counterclockwise triangle winds once around `q` if it covers it, and not at all if it does not. Add up
//! all triangles' boundaries: an edge with a triangle on each side is run through once in each direction and cancels,
//! what stays is the boundary of step 4. So the number of triangles that cover `q` is the number of times that the
//! boundary winds around `q`. A closed line that never turns right and whose direction goes round once is a convex
//! polygon, which winds once around its inside and not at all around the rest. Every point is a vertex, and no vertex
//! lies outside, so this polygon is the convex hull of all points. A vertex in the middle of another triangle's edge
//! is impossible too: the three edges would stay in the sum as a closed line of their own. Nothing here assumed that
//! the links are sound or the stars connected; step 2 gives that for those who walk the mesh.
//!
//! *It is the constrained Delaunay triangulation.* For a triangulation of a convex polygon that contains all
//! constraints, local Delaunayhood of all other inner edges is constrained Delaunayhood of all triangles (Lee and Lin
//! 1986; without constraints Delaunay 1934, see references.bib). With ties settled by the canonical rule, which
//! is a perturbation of the heights on the paraboloid, the same theorem makes it unique.
//!
//! # Cost
//!
//! A few sorts and linear sweeps, side by side on all threads of the current rayon pool: about 60 bytes a point beyond
//! input and mesh, n log n steps in the worst case, whatever the mesh.

mod constraints;
mod delaunay;
mod hull;
mod mesh;
mod order;
mod own;
mod points;
mod stars;
mod triangles;
mod verdict;

pub use verdict::{Kind, LISTED, Place, Problem, Verdict};

use constraints::Marks;
use mesh::Mesh;
use polder_mesh::{Pslg, Triangulation};
use stars::Star;
use verdict::Found;

/// Checks the triangles of any mesh against its input.
///
/// ```
/// use polder::verify::{self, Kind};
/// use polder_mesh::{DVec2, Pslg};
///
/// let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0), (1.0, 1.0)];
/// let pslg = Pslg::new(corners.map(DVec2::from).to_vec(), vec![])?;
///
/// let whole = [[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4]];
/// assert!(verify::check(&pslg, &whole).is_canonical());
///
/// let verdict = verify::check(&pslg, &whole[..3]);
/// assert!(!verdict.is_valid());
/// assert_eq!(verdict.problems()[0].kind, Kind::Notch);
/// # Ok::<(), polder_mesh::MeshError>(())
/// ```
pub fn check(pslg: &Pslg, triangles: &[[u32; 3]]) -> Verdict {
    let mut found = Found::default();
    inspect(pslg, triangles, &mut found);
    Verdict::new(pslg, triangles.len(), found)
}

/// Checks a triangulation of ours with all that it holds: the triangles as [`check`] does, and neighbors, constrained
/// bits, representatives of equal points, and the chain of each constraint.
pub fn check_triangulation(pslg: &Pslg, triangulation: &Triangulation) -> Verdict {
    let mut found = Found::default();
    let triangles = triangulation.triangles();
    if let Some(inspected) = inspect(pslg, triangles, &mut found) {
        own::check(pslg, triangulation, &inspected, &mut found);
    }
    Verdict::new(pslg, triangles.len(), found)
}

/// What the checks of bare triangles have found out.
struct Inspected<'a> {
    mesh: Mesh<'a>,
    marks: Marks,
    representatives: Vec<u32>,
}

/// All checks of bare triangles; nothing comes back if there are too many of them to number their edges.
fn inspect<'a>(pslg: &'a Pslg, triangles: &'a [[u32; 3]], found: &mut Found) -> Option<Inspected<'a>> {
    if triangles.len() > (u32::MAX / 3 - 1) as usize {
        found.add(Kind::TooManyTriangles, Place::Mesh);
        return None;
    }
    let points = pslg.points();
    let representatives = points::representatives(points);
    let sound = triangles::check(points, &representatives, triangles, found);
    let mut mesh = Mesh::new(points, sound);
    stars::drop_repeated(&mut mesh, found);

    let stars = stars::check(&mesh, found);
    points::check_used(&mesh, &representatives, triangles, found);
    if !stars.contains(&Star::Crowded) {
        hull::check(&mesh, &stars, found);
    }
    let marks = constraints::check(&mesh, &representatives, pslg.constraints(), found);
    delaunay::check(&mesh, &marks, found);
    order::check(&representatives, triangles, found);
    Some(Inspected { mesh, marks, representatives })
}
