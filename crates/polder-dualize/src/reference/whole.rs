//! Stages 1 to 4 in a row.

use super::{ToInsert, dual, insert, shift};
use crate::{DualizeError, Dualized, Inserted, Shifted};
use glam::DVec2;
use polder_mesh::NONE;
use polder_voronoi::{Diagram, Options, Sites};

/// What each of the stages 1 to 4 gives for one set of points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Phases {
    /// Stage 1: the grid, the renumbering and the diagram.
    pub voronoi: polder_voronoi::reference::Output,
    /// Stage 2, its hull not yet convex: stage 3 closes it.
    pub dualized: Dualized,
    /// Stage 3.
    pub shifted: Shifted,
    /// Stage 4.
    pub inserted: Inserted,
}

impl Phases {
    /// The positions of the vertices of all meshes here but the dualized one: the points, in the renumbering.
    pub fn positions(&self, points: &[DVec2]) -> Vec<DVec2> {
        self.voronoi.sites.order.iter().map(|&i| points[i as usize]).collect()
    }

    /// The positions of the dualized mesh's vertices: the pixel centers of the sites.
    pub fn centers(&self) -> Vec<DVec2> {
        centers(&self.voronoi)
    }
}

/// Triangulates points: stages 1 to 4.
///
/// # Errors
///
/// [`DualizeError::Voronoi`] for no points, or a coordinate that is not finite; other errors are bugs.
pub fn triangulate(points: &[DVec2], options: &Options) -> Result<Phases, DualizeError> {
    let voronoi = polder_voronoi::reference::diagram(points, options)?;
    let positions: Vec<DVec2> = voronoi.sites.order.iter().map(|&i| points[i as usize]).collect();
    let dualized = dual(&voronoi.diagram, &voronoi.sites)?;
    let shifted = shift(dualized.mesh.clone(), &centers(&voronoi), &positions)?;
    let new = points_to_insert(&voronoi.diagram, &voronoi.sites, &shifted);
    let inserted = insert(shifted.mesh.clone(), &positions, &new)?;
    Ok(Phases { voronoi, dualized, shifted, inserted })
}

/// The points that stage 4 must insert, with a vertex close to each and the slots of each: the sites taken out with their
/// heirs and the slots that they left, then the missing points, each with the site that owns its pixel, or that one's
/// heir. The dualized mesh of `s` sites has `2 s - 2` slots, so that missing point `i` has `2 i - 2` and `2 i - 1`; from an
/// empty mesh all points have these, but for the first one.
pub fn points_to_insert(diagram: &Diagram, sites: &Sites, shifted: &Shifted) -> ToInsert {
    let own = |i: u32| if i == 0 { [NONE; 2] } else { [2 * i - 2, 2 * i - 1] };
    let mut new = ToInsert::default();
    for (site, heir) in shifted.taken_out() {
        new.points.push(site);
        new.starts.push(heir);
        new.slots.push(if shifted.mesh.slots() == 0 { own(site) } else { shifted.freed[site as usize] });
    }
    for i in sites.count..sites.order.len() {
        let owner = diagram.color(sites.pixels[i]) as usize;
        new.points.push(i as u32);
        new.starts.push(shifted.heirs.get(owner).copied().unwrap_or(NONE));
        new.slots.push(own(i as u32));
    }
    new
}

/// The pixel centers of the sites.
pub fn centers(voronoi: &polder_voronoi::reference::Output) -> Vec<DVec2> {
    let sites = &voronoi.sites;
    sites.pixels[..sites.count].iter().map(|&pixel| voronoi.mapping.center(pixel.map(u32::from))).collect()
}
