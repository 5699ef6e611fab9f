//! The stages that live at the points' true positions.

use super::{MARGIN, SIDE};
use glam::DVec2;
use polder::Stages;
use polder_io::svg::{Frame, Picture, Widths, colors};
use polder_mesh::{DELETED, GhostMesh, next, prev};

/// The edges of a mesh with two finite ends, each once, as half-edges.
fn edges(mesh: &GhostMesh) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
    let corner = |h: u32| mesh.triangles[h as usize / 3][h as usize % 3];
    (0..3 * mesh.slots() as u32).filter_map(move |h| {
        let ends = [corner(next(h)), corner(prev(h))];
        let once = !mesh.is_deleted(h as usize / 3) && h < mesh.twin(h);
        (once && ends.iter().all(|&v| v < DELETED)).then_some((h, ends))
    })
}

/// Land, edges, constrained edges.
pub(super) fn mesh(picture: &mut Picture, mesh: &GhostMesh, at: &impl Fn(u32) -> DVec2, widths: Widths, land: bool) {
    if land {
        picture.triangles(mesh.finite().map(|t| mesh.triangles[t].map(at)), colors::LAND);
    }
    let plain = edges(mesh).filter(|&(h, _)| !mesh.is_constrained(h));
    picture.lines(plain.map(|(_, ends)| ends.map(at)), colors::EDGE, widths.edge);
    let strong = edges(mesh).filter(|&(h, _)| mesh.is_constrained(h));
    picture.lines(strong.map(|(_, ends)| ends.map(at)), colors::CONSTRAINT, widths.constraint);
}

/// How many vertices a mesh has dots for at most.
const DOTS: usize = 4000;

fn begin(stages: &Stages) -> (Picture, Widths) {
    let frame = Frame::fit(&stages.positions, SIDE, MARGIN);
    (Picture::new(frame), Widths::of(&frame, stages.positions.len()))
}

fn used(mesh: &GhostMesh, points: usize) -> Vec<bool> {
    let mut used = vec![false; points];
    mesh.triangles.iter().flatten().filter(|&&v| v < DELETED).for_each(|&v| used[v as usize] = true);
    used
}

/// Dots for the vertices, and for marked points.
fn dots(picture: &mut Picture, stages: &Stages, widths: Widths, class: impl Fn(usize) -> Option<bool>) {
    let marked = |want: bool| {
        let all = (0..stages.positions.len()).filter(|&i| class(i) == Some(want));
        all.map(|i| stages.positions[i]).collect::<Vec<_>>()
    };
    if stages.positions.len() <= DOTS {
        picture.dots(marked(false), colors::POINT, widths.dot);
    }
    picture.dots(marked(true), colors::MARK, 1.2 * widths.dot);
}

/// The sites at their true positions; those taken out are marked.
pub(super) fn shifted(stages: &Stages) -> (Picture, String) {
    let (mut picture, widths) = begin(stages);
    mesh(&mut picture, &stages.shifted.mesh, &|v| stages.positions[v as usize], widths, true);
    let count = stages.voronoi.sites.count;
    let used = used(&stages.shifted.mesh, stages.positions.len());
    dots(&mut picture, stages, widths, |i| (i < count).then(|| !used[i]));
    let out = (0..count).filter(|&i| !used[i]).count();
    (picture, format!("{} sites, {out} taken out", count - out))
}

/// All points; those that were put in just now are marked.
pub(super) fn inserted(stages: &Stages) -> (Picture, String) {
    let (mut picture, widths) = begin(stages);
    mesh(&mut picture, &stages.inserted.mesh, &|v| stages.positions[v as usize], widths, true);
    let before = used(&stages.shifted.mesh, stages.positions.len());
    dots(&mut picture, stages, widths, |i| Some(!before[i]));
    (picture, format!("{} points, {} put in", stages.positions.len(), before.iter().filter(|b| !**b).count()))
}

/// All constraints in, before the flips.
pub(super) fn constrained(stages: &Stages) -> (Picture, String) {
    let (mut picture, widths) = begin(stages);
    mesh(&mut picture, &stages.constrained, &|v| stages.positions[v as usize], widths, true);
    if stages.positions.len() <= DOTS {
        picture.dots(stages.positions.iter().copied(), colors::POINT, widths.dot);
    }
    (picture, format!("{} points, {} constraints", stages.positions.len(), stages.walk.chains.len()))
}
