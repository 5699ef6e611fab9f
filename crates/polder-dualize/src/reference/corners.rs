//! What meets at a corner of the grid.

use polder_mesh::GHOST;
use polder_voronoi::Diagram;

/// The corner of the grid at column `x` and row `y`, counted in pixel sides: `0..=width` and `0..=height`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) x: u32,
    pub(super) y: u32,
}

/// What meets at a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One or two colors that do not cross: nothing, or a border passing by.
    Plain,
    /// Three colors, the repeated one on pixels `r` and `r + 1`: a digital Voronoi vertex with one triangle.
    Three { r: usize },
    /// Four colors: a digital Voronoi vertex with two triangles.
    Four,
    /// Three colors, the repeated one on pixels `r` and `r + 2`: a neck, which is no vertex.
    Neck { r: usize },
    /// Two colors, each on two opposite pixels. Flooding does not make this.
    Crossing,
}

/// The colors of the four pixels around a corner, counterclockwise from the south-west; outside the grid, [`GHOST`].
/// Side `s` of the corner lies between pixels `s` and `s + 1`: south, east, north, west.
pub(super) fn colors(diagram: &Diagram, corner: Corner) -> [u32; 4] {
    let Corner { x, y } = corner;
    let color = |x: u32, y: u32| {
        // One column to the left of the grid wraps round to a number beyond its width.
        if x < diagram.width && y < diagram.height {
            diagram.colors[y as usize * diagram.width as usize + x as usize]
        } else {
            GHOST
        }
    };
    let (west, south) = (x.wrapping_sub(1), y.wrapping_sub(1));
    [color(west, south), color(x, south), color(x, y), color(west, y)]
}

pub(super) fn kind(c: [u32; 4]) -> Kind {
    let borders = (0..4).filter(|&s| c[s] != c[(s + 1) % 4]).count();
    match borders {
        4 if c[0] == c[2] && c[1] == c[3] => Kind::Crossing,
        4 if c[0] == c[2] => Kind::Neck { r: 0 },
        4 if c[1] == c[3] => Kind::Neck { r: 1 },
        4 => Kind::Four,
        3 => Kind::Three { r: (0..4).position(|s| c[s] == c[(s + 1) % 4]).unwrap_or(0) },
        _ => Kind::Plain,
    }
}

impl Kind {
    /// How many triangles are dual to the corner.
    pub(super) fn triangles(self) -> u32 {
        match self {
            Kind::Four => 2,
            Kind::Three { .. } => 1,
            _ => 0,
        }
    }

    /// The half-edge that crosses side `s` of a vertex whose first triangle has slot `first`.
    pub(super) fn half_edge(self, first: u32, s: usize) -> u32 {
        // Of a triangle with corners c0, c1, c2 the edge from c0 to c1 is edge 2, then come 0 and 1.
        const EDGE: [u32; 3] = [2, 0, 1];
        match self {
            Kind::Three { r } => 3 * first + EDGE[(s + 3 - r) % 4],
            _ => [3 * first + 2, 3 * first, 3 * first + 3, 3 * first + 4][s],
        }
    }
}

impl Corner {
    /// The corner at the other end of side `s`.
    pub(super) fn across(self, s: usize) -> Self {
        let Self { x, y } = self;
        match s {
            0 => Self { x, y: y - 1 },
            1 => Self { x: x + 1, y },
            2 => Self { x, y: y + 1 },
            _ => Self { x: x - 1, y },
        }
    }
}
