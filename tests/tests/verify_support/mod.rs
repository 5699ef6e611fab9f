//! Meshes of other hands for the checker's tests.
#![allow(dead_code, reason = "each test binary uses a part")]

use polder_mesh::{DVec2, Pslg};
use spade::{ConstrainedDelaunayTriangulation, DelaunayTriangulation, HasPosition, Point2};

/// A point that remembers its index.
#[derive(Clone, Copy)]
pub(crate) struct Named {
    at: DVec2,
    index: u32,
}

impl HasPosition for Named {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.at.x, self.at.y)
    }
}

fn named(pslg: &Pslg) -> Vec<Named> {
    pslg.points().iter().enumerate().map(|(i, &at)| Named { at, index: i as u32 }).collect()
}

fn corners(mesh: &impl spade::Triangulation<Vertex = Named>) -> Vec<[u32; 3]> {
    mesh.inner_faces().map(|face| face.vertices().map(|v| v.data().index)).collect()
}

/// Spade's triangulation of the input, constrained if there are constraints; none where it does not take the
/// coordinates (too small ones) or stops at a constraint.
pub(crate) fn by_spade(pslg: &Pslg) -> Option<Vec<[u32; 3]>> {
    if pslg.constraints().is_empty() {
        return Some(corners(&DelaunayTriangulation::<Named>::bulk_load_stable(named(pslg)).ok()?));
    }
    let constraints = pslg.constraints().iter().map(|c| c.map(|v| v as usize)).collect();
    let mut stopped = false;
    let mesh = ConstrainedDelaunayTriangulation::<Named>::try_bulk_load_cdt(named(pslg), constraints, |_| {
        stopped = true;
    });
    let mesh = mesh.ok()?;
    (!stopped).then(|| corners(&mesh))
}

/// A PSLG from bare coordinates.
pub(crate) fn pslg(points: &[(f64, f64)], constraints: &[[u32; 2]]) -> Pslg {
    Pslg::new(points.iter().map(|&p| p.into()).collect(), constraints.to_vec()).expect("finite points, known indices")
}
