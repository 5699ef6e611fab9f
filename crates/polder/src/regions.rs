//! Where points lie in a triangulation, and which part of it is the domain.
//!
//! [`Regions`] says what constrained edges divide a triangulation into, and how deep each part lies; it needs no
//! positions. Here stands what does: finding the region of a point, for holes and labels. Signs are exact, so a point
//! on a constrained edge is found to be on it, and is then of no region.
//!
//! ```
//! use polder::{DVec2, Options, Pslg, regions, triangulate};
//!
//! // A square with a square hole, whose corners are 4 to 7, and a point far off.
//! let at = |list: &[(f64, f64)]| list.iter().map(|&p| DVec2::from(p)).collect::<Vec<_>>();
//! let points = at(&[(0., 0.), (9., 0.), (9., 9.), (0., 9.), (3., 3.), (6., 3.), (6., 6.), (3., 6.), (20., 5.)]);
//! let square = |i: u32| (0..4).map(move |k| [i + k, i + (k + 1) % 4]);
//! let pslg = Pslg::new(points, square(0).chain(square(4)).collect())?;
//! let whole = triangulate(&pslg, &Options::default())?.triangulation;
//!
//! let domain = regions::domain(pslg.points(), &whole, &[DVec2::new(4.0, 5.0)])?;
//! assert_eq!((whole.triangles().len(), domain.triangulation.triangles().len()), (11, 8));
//! // The even-odd rule finds the hole by itself.
//! let by_parity = whole.filter(|t| domain.regions.is_inside(domain.regions.region(t))).0;
//! assert_eq!(by_parity, domain.triangulation);
//! # Ok::<(), polder::Error>(())
//! ```

use crate::{DVec2, EdgeId, Error, MeshError, TriangleId, Triangulation, VertexId};
use polder_mesh::NONE;
pub use polder_mesh::Regions;
use polder_predicates::{Sign, orient2d};
use rayon::prelude::*;

/// Where a point lies in a triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// In no triangle.
    Outside,
    /// Strictly inside a triangle.
    Inside(TriangleId),
    /// On an edge, seen from its lower triangle, but on no vertex.
    OnEdge(EdgeId),
    /// On a vertex.
    OnVertex(VertexId),
}

/// A triangulation without its exterior and its holes.
#[derive(Clone, Debug)]
pub struct Domain {
    /// The triangles of the domain; vertices and constraints are numbered as before.
    pub triangulation: Triangulation,
    /// Which triangles of the whole these are.
    pub triangles: Vec<TriangleId>,
    /// The regions of the whole.
    pub regions: Regions,
    /// For each hole its region; none for one that lies in no triangle.
    pub holes: Vec<Option<u32>>,
}

/// Removes the exterior, everything that an unconstrained way leads to from outside the convex hull; and the region of
/// each hole, given by a point in it. Holes outside all triangles, or in the exterior, remove nothing more.
///
/// # Errors
///
/// [`Error::SeedOnConstraint`] with the first hole that lies on a constrained edge, between two regions;
/// [`Error::SeedNotFinite`]; [`Error::Input`] if the points are not those of the triangulation.
pub fn domain(points: &[DVec2], whole: &Triangulation, holes: &[DVec2]) -> Result<Domain, Error> {
    let regions = Regions::of(whole);
    let holes = regions_at(points, whole, &regions, holes)?;
    let mut removed: Vec<bool> = regions.depths().iter().map(|&depth| depth == 0).collect();
    holes.iter().flatten().for_each(|&region| removed[region as usize] = true);
    let (triangulation, triangles) = whole.filter(|t| !removed[regions.region(t) as usize]);
    Ok(Domain { triangulation, triangles, regions, holes })
}

/// For each region the lowest seed that lies in it.
///
/// # Errors
///
/// As [`domain`].
pub fn seed_of_regions(
    points: &[DVec2],
    whole: &Triangulation,
    regions: &Regions,
    seeds: &[DVec2],
) -> Result<Vec<Option<u32>>, Error> {
    let mut out = vec![None; regions.count()];
    for (seed, region) in regions_at(points, whole, regions, seeds)?.into_iter().enumerate() {
        if let Some(region) = region {
            out[region as usize].get_or_insert(seed as u32);
        }
    }
    Ok(out)
}

/// The region of each seed; none for one that lies in no triangle. A seed on an edge or a vertex is in the region around
/// it, if that is one alone.
///
/// # Errors
///
/// As [`domain`].
pub fn regions_at(
    points: &[DVec2],
    whole: &Triangulation,
    regions: &Regions,
    seeds: &[DVec2],
) -> Result<Vec<Option<u32>>, Error> {
    let mut out = Vec::with_capacity(seeds.len());
    for (seed, place) in locate(points, whole, seeds)?.into_iter().enumerate() {
        let around: Vec<TriangleId> = match place {
            Place::Outside => Vec::new(),
            Place::Inside(t) => vec![t],
            Place::OnEdge(edge) => [Some(edge), whole.twin(edge)].into_iter().flatten().map(EdgeId::triangle).collect(),
            Place::OnVertex(vertex) => whole.star(vertex),
        };
        let mut found = around.into_iter().map(|t| regions.region(t));
        let first = found.next();
        if found.any(|other| Some(other) != first) {
            return Err(Error::SeedOnConstraint { seed });
        }
        out.push(first);
    }
    Ok(out)
}

/// Where each seed lies. Exact, and the same however the search goes; quick where the triangulation is convex, as a whole
/// one is.
///
/// # Errors
///
/// [`Error::SeedNotFinite`]; [`Error::Input`] if the points are not those of the triangulation.
pub fn locate(points: &[DVec2], triangulation: &Triangulation, seeds: &[DVec2]) -> Result<Vec<Place>, Error> {
    if triangulation.representatives().len() > points.len() {
        let (triangle, what) = (0, "a triangulation of more points than there are positions");
        return Err(MeshError::Broken { triangle, what }.into());
    }
    if let Some(seed) = seeds.iter().position(|p| !p.is_finite()) {
        return Err(Error::SeedNotFinite { seed });
    }
    let mesh = Located { points, mesh: triangulation, is_convex: is_convex(points, triangulation) };
    let mut places = vec![Place::Outside; seeds.len()];
    if triangulation.triangles().is_empty() {
        return Ok(places);
    }
    let mut from = 0;
    for i in along_a_curve(seeds) {
        let place = mesh.walk(&mut from, seeds[i]).unwrap_or_else(|| mesh.search(seeds[i]));
        places[i] = place;
    }
    Ok(places)
}

/// Indices of points so that successive ones are close to each other: by a Morton curve over their box.
fn along_a_curve(points: &[DVec2]) -> Vec<usize> {
    let low = points.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = points.iter().copied().reduce(DVec2::max).unwrap_or_default();
    // Halves, so that no difference overflows; a box without extent gives NaN, which becomes 0.
    let cell = |x: f64, low: f64, high: f64| ((x / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0) * 65535.0) as u16;
    let spread = |x: u16| (0..16).fold(0u32, |bits, i| bits | (u32::from(x) >> i & 1) << (2 * i));
    let key = |p: DVec2| spread(cell(p.x, low.x, high.x)) | spread(cell(p.y, low.y, high.y)) << 1;
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_cached_key(|&i| (key(points[i]), i));
    order
}

/// Whether the triangles' border is one ring that turns right nowhere.
fn is_convex(points: &[DVec2], mesh: &Triangulation) -> bool {
    let border = mesh.neighbors().iter().flatten().filter(|&&n| n == NONE).count();
    let hull: Vec<DVec2> = mesh.hull().iter().map(|v| points[v.index()]).collect();
    let at = |i: usize| hull[i % hull.len()];
    border == hull.len() && (0..border).all(|i| orient2d(at(i), at(i + 1), at(i + 2)) != Sign::Negative)
}

struct Located<'a> {
    points: &'a [DVec2],
    mesh: &'a Triangulation,
    is_convex: bool,
}

impl Located<'_> {
    /// The sides of a triangle's edges that `p` is on, or the first edge from `first` on that it lies beyond.
    fn beyond(&self, t: u32, first: usize, p: DVec2) -> Result<[Sign; 3], usize> {
        let corners = self.mesh.triangles()[t as usize].map(|v| self.points[v as usize]);
        let mut signs = [Sign::Zero; 3];
        for k in (first..first + 3).map(|k| k % 3) {
            signs[k] = orient2d(corners[(k + 1) % 3], corners[(k + 2) % 3], p);
            if signs[k] == Sign::Negative {
                return Err(k);
            }
        }
        Ok(signs)
    }

    /// The place of a point of triangle `t`, given by its signs.
    fn place(&self, t: u32, signs: [Sign; 3]) -> Place {
        let on: Vec<usize> = (0..3).filter(|&k| signs[k] == Sign::Zero).collect();
        match on[..] {
            [] => Place::Inside(TriangleId(t)),
            [k] => {
                let edge = EdgeId::of(TriangleId(t), k);
                Place::OnEdge(self.mesh.twin(edge).map_or(edge, |twin| twin.min(edge)))
            }
            [k, j, ..] => Place::OnVertex(VertexId(self.mesh.triangles()[t as usize][3 - k - j])),
        }
    }

    /// A walk from triangle `from`, which it replaces by the one where it ends. None if it leads to the border of a mesh
    /// that is not convex, or goes on for too long: it crosses any edge that the point lies beyond, the first one that is
    /// looked at being drawn by lot, since always the same one could lead round in a circle.
    fn walk(&self, from: &mut u32, p: DVec2) -> Option<Place> {
        let bound = 1000 + 32 * (self.mesh.triangles().len() as f64).sqrt() as u64;
        let mut lot = 1u32;
        for _ in 0..bound {
            lot = lot.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            match self.beyond(*from, (lot >> 16) as usize % 3, p) {
                Ok(signs) => return Some(self.place(*from, signs)),
                Err(k) => match self.mesh.neighbors()[*from as usize][k] {
                    NONE => return self.is_convex.then_some(Place::Outside),
                    other => *from = other,
                },
            }
        }
        None
    }

    /// All triangles, one after the other.
    fn search(&self, p: DVec2) -> Place {
        let count = self.mesh.triangles().len() as u32;
        let found = (0..count).into_par_iter().with_min_len(1 << 14).find_map_first(|t| {
            let signs = self.beyond(t, 0, p).ok()?;
            Some(self.place(t, signs))
        });
        found.unwrap_or(Place::Outside)
    }
}
