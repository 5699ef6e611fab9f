//! The kernels of stage 2.

use super::super::corners::{Corner, Kind, colors, kind};
use polder_mesh::NONE;
use polder_voronoi::Diagram;

/// What [`dualize_count`] finds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counted {
    /// For each word of 32 corners, row by row: which are vertices, and which of them have two triangles.
    pub vertices: Vec<[u32; 2]>,
    /// Triangles of each word.
    pub counts: Vec<u32>,
    /// How many necks there are.
    pub necks: u32,
    /// How many ghost triangles there are.
    pub ghosts: u32,
    /// The first corner where two colors cross.
    pub crossing: u32,
    /// The first pixel without the color of a site.
    pub uncolored: u32,
}

/// Words of corners in a row.
pub fn words_in_row(width: u32) -> u32 {
    width / 32 + 1
}

/// Finds the digital Voronoi vertices among the corners of the grid.
pub fn dualize_count(diagram: &Diagram, sites: u32) -> Counted {
    let (width, height) = (diagram.width, diagram.height);
    let words = words_in_row(width) as usize * (height as usize + 1);
    let uncolored = diagram.colors.iter().position(|&color| color >= sites).map_or(NONE, |i| i as u32);
    let mut out = Counted {
        vertices: vec![[0; 2]; words],
        counts: vec![0; words],
        necks: 0,
        ghosts: 0,
        crossing: NONE,
        uncolored,
    };
    for y in 0..=height {
        for x in 0..=width {
            let word = (y * words_in_row(width) + x / 32) as usize;
            let kind = kind(colors(diagram, Corner { x, y }));
            out.counts[word] += kind.triangles();
            match kind {
                Kind::Three { .. } | Kind::Four => {
                    out.vertices[word][0] |= 1 << (x % 32);
                    out.vertices[word][1] |= u32::from(kind == Kind::Four) << (x % 32);
                    out.ghosts += u32::from(x == 0 || y == 0 || x == width || y == height);
                }
                Kind::Neck { .. } => out.necks += 1,
                Kind::Crossing => out.crossing = out.crossing.min(y * (width + 1) + x),
                Kind::Plain => {}
            }
        }
    }
    out
}
