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
//! Following a border needs no memory and no hashing. At a corner with two borders there is one way on. At a neck, one
//! of the two colors is on a single pixel there, and the border bends around that pixel. It always ends: read backwards
//! the way is unique as well, so it cannot close up without passing the vertex that it left. All ways together are as
//! long as all borders, twice.
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
//! The hull is then the sequence of colors along the border. Ghost flips close it (rather than a scan over the
//! border, as in [QCT]: flips run in parallel, and later stages need them anyway). Why they may: along the lower side
//! of the grid the x coordinates of the colors' sites ascend, and below the chain of these sites there is no site,
//! because a circle about a point of the border through two successive sites is empty, and so is what lies below it.
//! So a triangle that is cut off by a reflex vertex of the chain holds no site, the chain that remains has the same
//! property, and so on; likewise for the other three sides. At the site of a grid's corner two chains meet; what is
//! cut off there lies below the one, right of the other, or nearer to the corner than its nearest site, and is empty
//! too. Flooding differs from the nearest-site coloring in debris alone, and the certificate does not rely on any of
//! this.
//!
//! Departures: [QCT] counts every corner with three colors as a vertex, necks too, which [CET] does not; it links
//! triangles through lists of the triangles around each point; and it puts a polygon of fake points around the sites.
//! [CET] leaves out sites on one line.

use super::certify::certify;
use super::corners::{Corner, Kind, colors, kind};
use crate::{DualizeError, Dualized};
use glam::DVec2;
use polder_flip::reference::close_hull;
use polder_mesh::{GhostMesh, NONE};
use polder_voronoi::{Diagram, Sites};

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
    let (mut mesh, necks) = dual(diagram, sites)?;
    let positions: Vec<_> = sites.pixels[..sites.count].iter().map(|&p| DVec2::from(p.map(f64::from))).collect();
    let open = mesh.finite().count();
    let hull = close_hull(&mut mesh, &positions)?;
    certify(&mesh, &positions, "dualize")?;
    Ok(Dualized { mesh, necks, open, hull })
}

/// Steps 1 to 3: the dual as it is, its hull not yet convex, and the number of necks passed over.
///
/// # Errors
///
/// As [`dualize`].
pub fn dual(diagram: &Diagram, sites: &Sites) -> Result<(GhostMesh, u64), DualizeError> {
    check(diagram, sites)?;
    let corners_in_row = diagram.width + 1;
    let corner = |i: usize| Corner { x: i as u32 % corners_in_row, y: i as u32 / corners_in_row };
    let count = corners_in_row as usize * (diagram.height as usize + 1);

    // Step 1. `first[i]` is the slot of corner i's first triangle.
    let mut first = vec![0u32; count];
    let (mut total, mut necks) = (0, 0);
    for (i, first) in first.iter_mut().enumerate() {
        let kind = kind(colors(diagram, corner(i)));
        match kind {
            Kind::Crossing => return Err(DualizeError::CrossingNecks { x: corner(i).x, y: corner(i).y }),
            Kind::Neck { .. } => necks += 1,
            _ => {}
        }
        *first = total;
        total += kind.triangles();
    }
    // A sphere of the sites and the ghost; one site alone has no edge and no triangle.
    let expected = if sites.count < 2 { 0 } else { 2 * sites.count - 2 };
    if total as usize != expected {
        return Err(DualizeError::NotASphere { triangles: total as usize, sites: sites.count, expected });
    }

    // Steps 2 and 3.
    let mut mesh = GhostMesh::with_slots(total as usize);
    for i in 0..count {
        let c = colors(diagram, corner(i));
        let kind = kind(c);
        let t = first[i] as usize;
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
            let h = kind.half_edge(first[i], s);
            let (to, side) = follow(diagram, corner(i), s)?;
            let j = to.y as usize * corners_in_row as usize + to.x as usize;
            let g = self::kind(colors(diagram, to)).half_edge(first[j], side);
            mesh.links[h as usize / 3][h as usize % 3] = g;
        }
    }
    each_site_is_seen(&mesh, sites.count)?;
    Ok((mesh, necks))
}

/// Follows the border that leaves `corner` by side `s` to the next vertex, and by which of its sides it arrives.
fn follow(diagram: &Diagram, corner: Corner, s: usize) -> Result<(Corner, usize), DualizeError> {
    let (mut at, mut out) = (corner, s);
    for _ in 0..4 * (u64::from(diagram.width) + 1) * (u64::from(diagram.height) + 1) {
        at = at.across(out);
        let arrived = (out + 2) % 4;
        let c = colors(diagram, at);
        out = match kind(c) {
            Kind::Three { .. } | Kind::Four => return Ok((at, arrived)),
            // Around the pixel whose color is not repeated; its sides are those numbered q - 1 and q.
            Kind::Neck { r } => {
                let q = if arrived % 2 == (r + 1) % 2 { arrived } else { (arrived + 1) % 4 };
                if q == arrived { (q + 3) % 4 } else { q }
            }
            _ => (1..4).map(|k| (arrived + k) % 4).find(|&s| c[s] != c[(s + 1) % 4]).unwrap_or(arrived),
        };
    }
    Err(DualizeError::CrossingNecks { x: corner.x, y: corner.y })
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
