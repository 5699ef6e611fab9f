use crate::{IoError, Source, node_poly, raw};
use glam::DVec2;
use polder_mesh::Pslg;
use std::path::Path;
use std::str::FromStr;

/// A PSLG as a file gives it, with all that the file says beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Input {
    /// The points and constraints.
    pub pslg: Pslg,
    /// The number of the first point in the file: 0 or 1.
    pub first: u32,
    /// How many attributes each point has.
    pub attributes_per_point: usize,
    /// The attributes, point by point.
    pub attributes: Vec<f64>,
    /// The boundary marker of each point, if the file has them.
    pub point_markers: Option<Vec<i64>>,
    /// The boundary marker of each constraint, if the file has them.
    pub constraint_markers: Option<Vec<i64>>,
    /// A point in each hole.
    pub holes: Vec<DVec2>,
    /// Regional attributes and area bounds.
    pub regions: Vec<Region>,
}

/// A line of a `.poly` file's last section: it speaks of the region that holds a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// A point in the region.
    pub point: DVec2,
    /// The attribute of its triangles.
    pub attribute: f64,
    /// The largest area that a triangle in it may have.
    pub max_area: Option<f64>,
}

/// The formats of planar straight-line graphs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum InputFormat {
    /// Triangle's `.node`: points alone.
    Node,
    /// Triangle's `.poly`: points, or none and they stand in the `.node` beside it; segments, holes, regions.
    Poly,
    /// Raw little-endian: u64 n, u64 m, n times two f64, m times two u32 that count from 0.
    Pslg,
}

impl FromStr for InputFormat {
    type Err = String;

    fn from_str(extension: &str) -> Result<Self, String> {
        match extension.to_ascii_lowercase().as_str() {
            "node" => Ok(Self::Node),
            "poly" => Ok(Self::Poly),
            "pslg" => Ok(Self::Pslg),
            _ => Err(format!("\"{extension}\" is no input format; there are node, poly and pslg")),
        }
    }
}

impl InputFormat {
    /// The format of a file by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        path.extension()?.to_str()?.parse().ok()
    }
}

impl Input {
    /// A PSLG alone, numbered from `first`.
    pub fn new(pslg: Pslg, first: u32) -> Self {
        Self { pslg, first, ..Self::default() }
    }

    /// Reads a file; its extension says in which format.
    ///
    /// # Errors
    ///
    /// [`IoError::Unsupported`] for an unknown extension; whatever else is wrong with the file.
    pub fn read(path: &Path) -> Result<Self, IoError> {
        let format = InputFormat::of(path).ok_or_else(|| IoError::Unsupported {
            file: path.display().to_string(),
            what: "its extension is none of .node, .poly and .pslg".into(),
        })?;
        Self::read_from(Source::open(path)?, format)
    }

    /// Reads a source. Memory grows with what is there, never with what is promised.
    ///
    /// # Errors
    ///
    /// Any [`IoError`], the first that is met.
    pub fn read_from(source: Source, format: InputFormat) -> Result<Self, IoError> {
        match format {
            InputFormat::Node => node_poly::read_node(source),
            InputFormat::Poly => node_poly::read_poly(source),
            InputFormat::Pslg => raw::read_pslg(source).map(|pslg| Self::new(pslg, 0)),
        }
    }

    /// Whether a user may expect a part of the convex hull alone: there is a hole, or the constraints close an outline.
    pub fn has_holes_or_closed_outline(&self) -> bool {
        if !self.holes.is_empty() {
            return true;
        }
        // Constraints close an outline where one joins two points that earlier ones have joined already.
        let mut parents: Vec<u32> = (0..self.pslg.points().len() as u32).collect();
        self.pslg.constraints().iter().filter(|[a, b]| a != b).any(|&[a, b]| {
            let (a, b) = (root(&mut parents, a), root(&mut parents, b));
            // Toward the lower number, which halving of paths keeps shallow enough.
            parents[a.max(b) as usize] = a.min(b);
            a == b
        })
    }
}

/// The root of a point's tree; halves the path to it.
fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}
