//! Meshes: reading anybody's, writing ours.

mod ele;
mod obj;
mod ply;
mod vtk;

pub use ele::{write_edge, write_ele, write_neigh};
pub use obj::write_obj;
pub use ply::write_ply;
pub use vtk::write_vtk;

use crate::{IoError, Source, node_poly, raw};
use glam::DVec2;
use polder_mesh::Triangulation;
use std::path::Path;
use std::str::FromStr;

/// The formats of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Triangle's `.ele`: corners of triangles, numbered as the points.
    Ele,
    /// Raw little-endian: u64 t, t times three u32 that count from 0.
    Tri,
    /// Wavefront `.obj`.
    Obj,
    /// Stanford `.ply`.
    Ply,
    /// Legacy `.vtk`.
    Vtk,
    /// A picture; cannot be read back.
    Svg,
}

impl FromStr for MeshFormat {
    type Err = String;

    fn from_str(extension: &str) -> Result<Self, String> {
        Ok(match extension.to_ascii_lowercase().as_str() {
            "ele" => Self::Ele,
            "tri" => Self::Tri,
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "vtk" => Self::Vtk,
            "svg" => Self::Svg,
            _ => return Err(format!("\"{extension}\" is no mesh format; there are ele, tri, obj, ply, vtk and svg")),
        })
    }
}

impl MeshFormat {
    /// The format of a file by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        path.extension()?.to_str()?.parse().ok()
    }
}

/// A mesh as a file gives it. Nothing about it is checked but that corners are vertices, where the file has vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// The corners of each triangle, counted from 0, in the file's order.
    pub triangles: Vec<[u32; 3]>,
    /// The file's own vertices, where it has them: an `.ele` has them in the `.node` beside it.
    pub vertices: Option<Vec<DVec2>>,
    /// The number of the first triangle and vertex in the file: 0 or 1.
    pub first: u32,
}

impl MeshFile {
    /// Reads a file; its extension says in which format.
    ///
    /// # Errors
    ///
    /// [`IoError::Unsupported`] for an unknown extension; whatever else is wrong with the file.
    pub fn read(path: &Path) -> Result<Self, IoError> {
        let format = MeshFormat::of(path).ok_or_else(|| IoError::Unsupported {
            file: path.display().to_string(),
            what: "its extension is none of .ele, .tri, .obj, .ply and .vtk".into(),
        })?;
        Self::read_from(Source::open(path)?, format)
    }

    /// Reads a source. Memory grows with what is there, never with what is promised.
    ///
    /// # Errors
    ///
    /// Any [`IoError`], the first that is met.
    pub fn read_from(source: Source, format: MeshFormat) -> Result<Self, IoError> {
        match format {
            MeshFormat::Ele => {
                let vertices = match source.beside("node") {
                    Some(Ok(node)) => Some(node_poly::read_node(node)?),
                    _ => None,
                };
                ele::read(source, vertices)
            }
            MeshFormat::Tri => Ok(Self { triangles: raw::read_tri(source)?, ..Self::default() }),
            MeshFormat::Obj => obj::read(source),
            MeshFormat::Ply => ply::read(source),
            MeshFormat::Vtk => vtk::read(source),
            MeshFormat::Svg => {
                Err(IoError::Unsupported { file: source.name, what: "a picture cannot be read as a mesh".into() })
            }
        }
    }

    /// Renames the file's vertices to the points of an input equal to them: itself where it has the same index, else
    /// the lowest one.
    ///
    /// # Errors
    ///
    /// The first vertex that is a corner but equals no point.
    pub fn name_by_points(&mut self, points: &[DVec2]) -> Result<(), u32> {
        let Some(vertices) = self.vertices.take() else { return Ok(()) };
        if vertices == points {
            return Ok(());
        }
        let order = by_value(points);
        let name = |i: usize, &p: &DVec2| {
            if points.get(i) == Some(&p) {
                return Some(i as u32);
            }
            let place = order.partition_point(|&j| key(points[j as usize]) < key(p));
            order.get(place).copied().filter(|&j| points[j as usize] == p)
        };
        let names: Vec<_> = vertices.iter().enumerate().map(|(i, p)| name(i, p)).collect();
        for corner in self.triangles.iter_mut().flatten() {
            // A corner beyond the vertices stays beyond the points too, for the checker to find.
            let name = names.get(*corner as usize).copied().unwrap_or(Some(u32::MAX));
            *corner = name.ok_or(*corner)?;
        }
        Ok(())
    }
}

/// For each point the lowest one equal to it.
pub fn lowest_equal(points: &[DVec2]) -> Vec<u32> {
    let mut lowest = vec![0; points.len()];
    for equal in by_value(points).chunk_by(|&i, &j| points[i as usize] == points[j as usize]) {
        equal.iter().for_each(|&i| lowest[i as usize] = equal[0]);
    }
    lowest
}

/// The same for equal points: adding 0.0 makes -0.0 into 0.0 and leaves the rest.
fn key(p: DVec2) -> [u64; 2] {
    [p.x + 0.0, p.y + 0.0].map(f64::to_bits)
}

/// The points sorted so that equal ones are neighbors, the lowest first.
fn by_value(points: &[DVec2]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(points[i as usize]), i));
    order
}

/// The constrained edges of a triangulation; where it has no triangles, the pieces of its chains.
pub(crate) fn constrained_edges(triangulation: &Triangulation) -> Vec<[u32; 2]> {
    if !triangulation.triangles().is_empty() {
        return triangulation.edges().filter(|e| e.constrained).map(|e| e.vertices.map(|v| v.0)).collect();
    }
    let pieces = triangulation.chains().iter().flat_map(|chain| chain.windows(2));
    let mut edges: Vec<_> = pieces.map(|w| [w[0].min(w[1]), w[0].max(w[1])]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}
