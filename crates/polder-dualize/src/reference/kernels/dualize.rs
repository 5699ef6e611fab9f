//! The kernels of stage 2.

use super::super::corners::{Corner, Kind, colors, kind};
pub use super::super::dualize::triangles_of;
use super::super::dualize::{follow, write};
use polder_mesh::{GhostMesh, NONE};
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

/// How many triangles there will be.
pub fn dualize_check(sites: u32, total: u32, crossing: u32, uncolored: u32, limit: u32) -> u32 {
    let expected = triangles_of(sites as usize) as u32;
    let is_good = crossing == NONE && uncolored == NONE && total == expected && expected <= limit;
    if is_good { expected } else { 0 }
}

/// What [`dualize_write`] writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The triangles and their links; no link where a border leads nowhere.
    pub mesh: GhostMesh,
    /// The first corner that a border leaves and leads nowhere.
    pub lost: u32,
    /// The first finite triangle that is not counterclockwise.
    pub folded: u32,
}

/// Writes the triangles of each digital Voronoi vertex, and links them; none if there are to be no `slots`. `first` is
/// the slot of each word of corners, `pixels` where the sites are.
pub fn dualize_write(
    diagram: &Diagram,
    pixels: &[[u16; 2]],
    vertices: &[[u32; 2]],
    first: &[u32],
    slots: u32,
) -> Written {
    if slots == 0 {
        return Written { mesh: GhostMesh::default(), lost: NONE, folded: NONE };
    }
    let slot = &|y: u32, x: u32| slot_of(diagram, vertices, first, Corner { x, y });
    let first: Vec<u32> = (0..=diagram.height).flat_map(|y| (0..=diagram.width).map(move |x| slot(y, x))).collect();
    let (mesh, lost) = write(diagram, &first, slots as usize);
    let folded = mesh.finite().find(|&t| {
        let [a, b, c] = mesh.triangles[t].map(|v| pixels[v as usize].map(i32::from));
        (b[0] - a[0]) * (c[1] - a[1]) <= (b[1] - a[1]) * (c[0] - a[0])
    });
    Written {
        mesh,
        lost: lost.map_or(NONE, |Corner { x, y }| y * (diagram.width + 1) + x),
        folded: folded.map_or(NONE, |t| t as u32),
    }
}

/// The slot of a corner's first triangle.
fn slot_of(diagram: &Diagram, vertices: &[[u32; 2]], first: &[u32], Corner { x, y }: Corner) -> u32 {
    let word = (y * words_in_row(diagram.width) + x / 32) as usize;
    let before: u32 = vertices[word].iter().map(|bits| (bits & !(u32::MAX << (x % 32))).count_ones()).sum();
    first[word] + before
}

/// The half-edges of some borders, each with what it is linked to. `far` holds for each border a half-edge and a corner that
/// the border passes; their highest bits are the side by which it leaves that corner. None where it leads nowhere.
pub fn dualize_leap(
    diagram: &Diagram,
    vertices: &[[u32; 2]],
    first: &[u32],
    far: &[[u32; 2]],
) -> Vec<(u32, Option<u32>)> {
    let columns = diagram.width + 1;
    let link_of = |&[h, corner]: &[u32; 2]| {
        let side = (h >> 31 | corner >> 31 << 1) as usize;
        let (h, corner) = (h & !(1 << 31), corner & !(1 << 31));
        let end = follow(diagram, Corner { x: corner % columns, y: corner / columns }, side);
        let half_edge = |(to, side)| kind(colors(diagram, to)).half_edge(slot_of(diagram, vertices, first, to), side);
        (h, end.map(half_edge))
    };
    far.iter().map(link_of).collect()
}
