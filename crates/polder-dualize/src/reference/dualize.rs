//! Stage 2: the digital Delaunay triangulation. [CET] sections 2 and 3.3, [QCT] section 3.2.
//!
//! A corner of the grid where four pixels meet is a *digital Voronoi vertex* if they have four colors, or three and
//! the repeated one on pixels that share a side. With the repeated color on opposite pixels it is a *neck*, and no
//! vertex.
//!
//! 1. Count the triangles of each corner: one for three colors, two for four. A prefix sum of the counts gives each
//!    triangle its slot, in the order of corners row by row.
//! 2. Write the triangles, counterclockwise as their pixels lie around the corner. Four colors are cut along the
//!    diagonal from the south-west to the north-east pixel.
//! 3. Link neighbors: from each side of a vertex that separates two colors, follow the border between these colors
//!    to the next vertex. The side on which it is reached belongs to the neighbor.
//! 4. Close the hull: ghost flips, with sites at their pixels.
//! 5. Check the certificate.
//!
//! [`dualize`] does all of it, for whoever wants the digital Delaunay triangulation. The stages in a row stop after step
//! 3, at [`dual`]: stage 3 would have to close the hull again anyway, after it has moved the sites, and its proof asks for
//! no more than the four monotone parts below.
//!
//! Following a border needs no memory and no hashing. At a corner with two borders there is one way on. At a neck, one
//! of the two colors is on a single pixel there, and the border bends around that pixel. It always ends: read backwards
//! the way is unique as well, so it cannot close up without passing the vertex that it left. All ways together are as
//! long as all borders, twice. A bound keeps colorings that flooding does not make from taking longer.
//!
//! # The hull
//!
//! Everything outside the grid has the color of the ghost vertex. So where the color changes along the grid's border,
//! the corner is a digital Voronoi vertex too, and its triangle is a ghost triangle; nothing else has to be said about
//! the border. A site whose region meets the border in several places gets several edges to the ghost; each links
//! the ghost triangles at the two ends of its piece of border. Sites on one line give a chain with ghost triangles on
//! both sides, a site whose region touches no vertex inside the grid gets two ghost triangles, and a grid one pixel
//! high needs nothing special.
//!
//! The hull is then the sequence of colors along the border: four parts, lower, right, upper and left, one for each side
//! of the grid, each strictly monotone in its direction, neighbors having the site of the grid's corner in common. Ghost
//! flips close it (rather than a scan over the border, as in [QCT]: flips run in parallel, and later stages need them
//! anyway). Why they may: along the lower side of the grid the x coordinates of the colors' sites ascend, and below the
//! chain of these sites there is no site, because a circle about a point of the border through two successive sites is
//! empty, and so is what lies below it. So a triangle that is cut off by a reflex vertex of the chain holds no site, the
//! chain that remains has the same property, and so on; likewise for the other three sides. At the site of a grid's corner
//! two chains meet; what is cut off there lies below the one, right of the other, or nearer to the corner than its nearest
//! site, and is empty too. Flooding differs from the nearest-site coloring in debris alone, and the certificate does not
//! rely on any of this.
//!
//! Departures: [QCT] counts every corner with three colors as a vertex, necks too, which [CET] does not; it links
//! triangles through lists of the triangles around each point; and it puts a polygon of fake points around the sites.
//! [CET] leaves out sites on one line.

use super::certify::certify;
use super::corners::{Corner, Kind, colors, kind};
use crate::{DualizeError, Dualized};
use glam::DVec2;
use polder_flip::FlipReport;
use polder_flip::reference::close_hull;
use polder_mesh::{GhostMesh, NONE};
use polder_voronoi::{Diagram, Sites};

/// How long a border may be: flooding makes none that is nearly as long, on any grid.
const LONGEST_BORDER: u32 = 1 << 22;

/// Dualizes a flooded diagram to a triangulation of its sites, with a convex hull.
///
/// Sites stand at the centers of their pixels; any exact image of the grid, turned or stretched along its axes alike,
/// gives the same triangles. One site, or none, gives the empty mesh.
///
/// # Errors
///
/// [`DualizeError::Mismatch`] if the diagram and the sites do not belong together. Every other error means that
/// flooding did not make the diagram.
pub fn dualize(diagram: &Diagram, sites: &Sites) -> Result<Dualized, DualizeError> {
    let mut dualized = dual(diagram, sites)?;
    let positions: Vec<_> = sites.pixels[..sites.count].iter().map(|&p| DVec2::from(p.map(f64::from))).collect();
    dualized.hull = close_hull(&mut dualized.mesh, &positions)?;
    certify(&dualized.mesh, &positions, "dualize")?;
    Ok(dualized)
}

/// Steps 1 to 3: the dual as it is, its hull not yet convex. This is what stage 3 takes, which closes the hull once its
/// sites have moved.
///
/// # Errors
///
/// As [`dualize`].
pub fn dual(diagram: &Diagram, sites: &Sites) -> Result<Dualized, DualizeError> {
    check(diagram, sites)?;
    // Step 1.
    let mut necks = 0;
    let mut first = Vec::with_capacity(corner_count(diagram));
    let mut total = 0;
    for corner in corners(diagram) {
        let kind = kind(colors(diagram, corner));
        match kind {
            Kind::Crossing => return Err(DualizeError::CrossingNecks { x: corner.x, y: corner.y }),
            Kind::Neck { .. } => necks += 1,
            _ => {}
        }
        first.push(total);
        total += kind.triangles();
    }
    let expected = triangles_of(sites.count);
    if total as usize != expected {
        return Err(DualizeError::NotASphere { triangles: total as usize, sites: sites.count, expected });
    }
    let (mesh, lost) = write(diagram, &first, expected);
    if let Some(Corner { x, y }) = lost {
        return Err(DualizeError::CrossingNecks { x, y });
    }
    each_site_is_seen(&mesh, sites.count)?;
    let open = mesh.finite().count();
    Ok(Dualized { mesh, necks, open, hull: FlipReport::default() })
}

/// The triangles of a sphere with the sites and the ghost as vertices; one site alone has no edge and no triangle.
pub fn triangles_of(sites: usize) -> usize {
    if sites < 2 { 0 } else { 2 * sites - 2 }
}

fn corner_count(diagram: &Diagram) -> usize {
    (diagram.width as usize + 1) * (diagram.height as usize + 1)
}

fn corners(diagram: &Diagram) -> impl Iterator<Item = Corner> + use<> {
    let (width, height) = (diagram.width, diagram.height);
    (0..=height).flat_map(move |y| (0..=width).map(move |x| Corner { x, y }))
}

/// Steps 2 and 3, where `first` is the slot of each corner's first triangle. Where a border leads nowhere there is no
/// link; the first corner with such a border comes back.
pub(super) fn write(diagram: &Diagram, first: &[u32], slots: usize) -> (GhostMesh, Option<Corner>) {
    let mut mesh = GhostMesh::with_slots(slots);
    let mut lost = None;
    for (corner, &first_here) in corners(diagram).zip(first) {
        let c = colors(diagram, corner);
        let kind = kind(c);
        let t = first_here as usize;
        match kind {
            Kind::Three { r } => mesh.triangles[t] = [c[(r + 1) % 4], c[(r + 2) % 4], c[(r + 3) % 4]],
            Kind::Four => {
                mesh.triangles[t] = [c[0], c[1], c[2]];
                mesh.triangles[t + 1] = [c[0], c[2], c[3]];
                mesh.link(3 * t as u32 + 1, 3 * (t as u32 + 1) + 2);
            }
            _ => continue,
        }
        for s in (0..4).filter(|&s| c[s] != c[(s + 1) % 4]) {
            let h = kind.half_edge(first_here, s);
            let Some((to, side)) = follow(diagram, corner, s) else {
                lost.get_or_insert(corner);
                continue;
            };
            let j = to.y as usize * (diagram.width as usize + 1) + to.x as usize;
            let g = self::kind(colors(diagram, to)).half_edge(first[j], side);
            mesh.links[h as usize / 3][h as usize % 3] = g;
        }
    }
    (mesh, lost)
}

/// Follows the border that leaves `corner` by side `s` to the next vertex, and by which of its sides it arrives.
pub(super) fn follow(diagram: &Diagram, corner: Corner, s: usize) -> Option<(Corner, usize)> {
    let (mut at, mut out) = (corner, s);
    for _ in 0..LONGEST_BORDER {
        at = at.across(out);
        let arrived = (out + 2) % 4;
        let c = colors(diagram, at);
        out = match kind(c) {
            Kind::Three { .. } | Kind::Four => return Some((at, arrived)),
            // Around the pixel whose color is not repeated; its sides are those numbered q - 1 and q.
            Kind::Neck { r } => {
                let q = if arrived % 2 == (r + 1) % 2 { arrived } else { (arrived + 1) % 4 };
                if q == arrived { (q + 3) % 4 } else { q }
            }
            _ => (1..4).map(|k| (arrived + k) % 4).find(|&s| c[s] != c[(s + 1) % 4]).unwrap_or(arrived),
        };
    }
    None
}

fn check(diagram: &Diagram, sites: &Sites) -> Result<(), DualizeError> {
    let mismatch = |what, index| Err(DualizeError::Mismatch { what, index });
    if sites.count > sites.pixels.len() {
        return mismatch("more sites than points", sites.count);
    }
    if diagram.colors.len() != diagram.width as usize * diagram.height as usize {
        return mismatch(
            "a diagram with a number of pixels that is not its width times its height",
            diagram.colors.len(),
        );
    }
    match diagram.colors.iter().position(|&c| c as usize >= sites.count) {
        Some(pixel) => mismatch("a pixel without the color of a site", pixel),
        None => Ok(()),
    }
}

/// Condition I, as far as the number of triangles does not say it: each site has a triangle.
fn each_site_is_seen(mesh: &GhostMesh, sites: usize) -> Result<(), DualizeError> {
    if mesh.slots() == 0 {
        return Ok(());
    }
    match mesh.half_edge_of_vertex(sites).iter().position(|&h| h == NONE) {
        Some(index) => Err(DualizeError::Mismatch { what: "a site that no region belongs to", index }),
        None => Ok(()),
    }
}
