//! Pictures: fine lines for edges, strong ones for constraints, y upwards.

mod frame;
mod picture;

pub use frame::Frame;
pub use picture::Picture;

use crate::mesh::constrained_edges;
use glam::DVec2;
use polder_mesh::Triangulation;
use std::io::{self, Write};

/// The colors of pictures: paper, land, dikes.
pub mod colors {
    /// The background.
    pub const PAPER: &str = "#fdfcf8";
    /// The land: the inside of triangles.
    pub const LAND: &str = "#edf2ec";
    /// Edges.
    pub const EDGE: &str = "#7d9ba6";
    /// Constrained edges.
    pub const CONSTRAINT: &str = "#c2410c";
    /// Points.
    pub const POINT: &str = "#12343b";
    /// What deserves a look: debris, points put in or taken out.
    pub const MARK: &str = "#d6246e";
    /// Regions of pixels.
    pub const REGIONS: [&str; 8] =
        ["#cfe4ec", "#d9ead3", "#f5e7bf", "#e4daee", "#c3d6ee", "#f6d8c9", "#cdeadf", "#ece6d6"];
}

/// How many points at most are drawn as dots.
const DOTS: usize = 2000;

/// Widths of lines and dots that suit a number of points.
#[derive(Clone, Copy, Debug)]
pub struct Widths {
    /// Of an edge.
    pub edge: f64,
    /// Of a constrained edge.
    pub constraint: f64,
    /// The radius of a point's dot.
    pub dot: f64,
}

impl Widths {
    /// For `points` points strewn over a frame.
    pub fn of(frame: &Frame, points: usize) -> Self {
        let spacing = (frame.width * frame.height / points.max(1) as f64).sqrt();
        Self {
            edge: (0.03 * spacing).clamp(0.08, 0.9),
            constraint: (0.09 * spacing).clamp(0.6, 2.4),
            dot: (0.07 * spacing).clamp(0.6, 3.0),
        }
    }
}

/// Writes a triangulation as a picture of 1000 units along its longer side.
///
/// # Errors
///
/// What `out` says.
pub fn write_svg(out: &mut dyn Write, points: &[DVec2], triangulation: &Triangulation) -> io::Result<()> {
    let frame = Frame::fit(points, 1000.0, 24.0);
    let vertices: Vec<_> = triangulation.vertices().map(|v| points[v.index()]).collect();
    let widths = Widths::of(&frame, vertices.len());
    let mut picture = Picture::new(frame);
    let of = |ids: &[u32]| ids.iter().map(|&v| points[v as usize]).collect::<Vec<_>>();
    let hull: Vec<_> = triangulation.hull().iter().map(|v| v.0).collect();
    let border = triangulation.neighbors().iter().flatten().filter(|&&n| n == polder_mesh::NONE).count();
    if border == hull.len() {
        picture.polygon(&of(&hull), colors::LAND);
    } else {
        // Several borders, or one that meets itself.
        let land = triangulation.triangles().iter().map(|corners| corners.map(|v| points[v as usize]));
        picture.triangles(land, colors::LAND);
    }
    let plain = triangulation.edges().filter(|e| !e.constrained);
    picture.lines(plain.map(|e| e.vertices.map(|v| points[v.index()])), colors::EDGE, widths.edge);
    let constrained = constrained_edges(triangulation);
    let ends = constrained.iter().map(|e| e.map(|v| points[v as usize]));
    picture.lines(ends, colors::CONSTRAINT, widths.constraint);
    if vertices.len() <= DOTS {
        picture.dots(vertices.iter().copied(), colors::POINT, widths.dot);
    }
    let title = format!("{} vertices, {} triangles", vertices.len(), triangulation.triangles().len());
    picture.write(out, &title)
}
