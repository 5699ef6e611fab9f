//! The stages that live on the pixel grid. One unit of the plane is a pixel here.

use super::{MARGIN, SIDE, meshes};
use glam::DVec2;
use polder::Stages;
use polder::voronoi::{Diagram, UNCOLORED};
use polder_io::svg::{Frame, Picture, Widths, colors};
use polder_mesh::Pslg;

/// The middle of a pixel.
fn middle(pixel: [u16; 2]) -> DVec2 {
    DVec2::from(pixel.map(f64::from)) + 0.5
}

fn begin(diagram: &Diagram) -> Picture {
    let corners = [DVec2::ZERO, DVec2::new(diagram.width as f64, diagram.height as f64)];
    Picture::new(Frame::fit(&corners, SIDE, MARGIN))
}

/// The digital Voronoi diagram: each region in a color of its own, debris, sites, missing points.
pub(super) fn voronoi(pslg: &Pslg, stages: &Stages) -> (Picture, String) {
    let (diagram, sites) = (&stages.voronoi.diagram, &stages.voronoi.sites);
    let mut picture = begin(diagram);
    regions(&mut picture, diagram, sites.count);
    let debris = diagram.debris.iter().map(|&i| DVec2::from(diagram.pixel(i as usize).map(f64::from)));
    picture.rectangles(debris.map(|p| [p, p + 1.0]), colors::MARK);
    borders(&mut picture, diagram);

    let unit = SIDE / diagram.width.max(diagram.height) as f64;
    picture.dots(sites.pixels[..sites.count].iter().map(|&p| middle(p)), colors::POINT, (0.3 * unit).min(4.0));
    let missing = (sites.count..sites.order.len()).map(|i| place(pslg, stages, i));
    picture.dots(missing, colors::CONSTRAINT, (0.22 * unit).min(3.0));
    let title = format!(
        "{} x {} pixels, {} sites, {} missing points, {} pixels of debris",
        diagram.width,
        diagram.height,
        sites.count,
        sites.missing(),
        diagram.debris.len()
    );
    (picture, title)
}

/// The triangulation of the sites, over a shade of their regions.
pub(super) fn dualized(stages: &Stages) -> (Picture, String) {
    let (diagram, sites) = (&stages.voronoi.diagram, &stages.voronoi.sites);
    let mut picture = begin(diagram);
    regions(&mut picture, diagram, sites.count);
    let widths = Widths::of(picture.frame(), sites.count);
    let widths = Widths { edge: 1.6 * widths.edge, ..widths };
    let at = |v: u32| middle(sites.pixels[v as usize]);
    meshes::mesh(&mut picture, &stages.dualized.mesh, &at, widths, false);
    picture.dots(sites.pixels[..sites.count].iter().map(|&p| middle(p)), colors::POINT, widths.dot);
    let title = format!("{} sites, {} triangles", sites.count, stages.dualized.mesh.finite().count());
    (picture, title)
}

/// Where a point lies, in pixels; within its own, whatever rounding does.
fn place(pslg: &Pslg, stages: &Stages, i: usize) -> DVec2 {
    let (mapping, sites) = (&stages.voronoi.mapping, &stages.voronoi.sites);
    let [x, y] = sites.pixels[i].map(u32::from);
    let center = mapping.center([x, y]);
    let beside = [if x > 0 { x - 1 } else { x + 1 }, if y > 0 { y - 1 } else { y + 1 }];
    let step = (center - mapping.center(beside)).abs();
    let offset = (pslg.points()[sites.order[i] as usize] - center) / step;
    let inside = if offset.is_finite() { offset.clamp(DVec2::splat(-0.5), DVec2::splat(0.5)) } else { DVec2::ZERO };
    middle(sites.pixels[i]) + inside
}

/// Paints every region; neighbors differ as far as the palette goes.
fn regions(picture: &mut Picture, diagram: &Diagram, sites: usize) {
    let tones = tones(diagram, sites);
    let (width, height) = (diagram.width as usize, diagram.height as usize);
    let mut runs: Vec<Vec<[DVec2; 2]>> = vec![Vec::new(); colors::REGIONS.len()];
    for y in 0..height {
        let row = &diagram.colors[y * width..][..width];
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            if run[0] != UNCOLORED {
                let corners = [DVec2::new(x as f64, y as f64), DVec2::new((x + run.len()) as f64, y as f64 + 1.0)];
                runs[tones[run[0] as usize] as usize].push(corners);
            }
            x += run.len();
        }
    }
    for (runs, fill) in runs.into_iter().zip(colors::REGIONS) {
        picture.rectangles(runs, fill);
    }
}

/// A tone for each region: the first one, from a start of its own, that no neighbor before it has.
fn tones(diagram: &Diagram, sites: usize) -> Vec<u8> {
    let width = diagram.width as usize;
    let mut pairs = Vec::new();
    for (i, &c) in diagram.colors.iter().enumerate() {
        let right = ((i + 1) % width != 0).then(|| diagram.colors[i + 1]);
        let above = diagram.colors.get(i + width).copied();
        for d in [right, above].into_iter().flatten() {
            if c != d && c != UNCOLORED && d != UNCOLORED {
                pairs.push([c.max(d), c.min(d)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let count = colors::REGIONS.len();
    let mut tones: Vec<u8> = (0..sites).map(|site| (site.wrapping_mul(5) % count) as u8).collect();
    for group in pairs.chunk_by(|a, b| a[0] == b[0]) {
        let site = group[0][0] as usize;
        let taken = |tone: u8| group.iter().any(|pair| tones[pair[1] as usize] == tone);
        let start = tones[site] as usize;
        let free = (0..count).map(|k| ((start + k) % count) as u8).find(|&tone| !taken(tone));
        tones[site] = free.unwrap_or(start as u8);
    }
    tones
}

/// Lines between regions, in long strokes.
fn borders(picture: &mut Picture, diagram: &Diagram) {
    let (width, height) = (diagram.width as usize, diagram.height as usize);
    let color = |x: usize, y: usize| diagram.colors[y * width + x];
    let mut lines = Vec::new();
    let mut strokes = |along: usize, across: usize, differ: &dyn Fn(usize, usize) -> bool, flip: bool| {
        for c in 1..across {
            let mut from = None;
            for a in 0..=along {
                let border = a < along && differ(a, c);
                match (border, from) {
                    (true, None) => from = Some(a),
                    (false, Some(begin)) => {
                        let ends = [begin, a].map(|a| DVec2::new(a as f64, c as f64));
                        lines.push(if flip { ends.map(|p| DVec2::new(p.y, p.x)) } else { ends });
                        from = None;
                    }
                    _ => {}
                }
            }
        }
    };
    strokes(width, height, &|x, y| color(x, y) != color(x, y - 1), false);
    strokes(height, width, &|y, x| color(x, y) != color(x - 1, y), true);
    let unit = SIDE / width.max(height) as f64;
    picture.lines(lines, colors::PAPER, (0.12 * unit).clamp(0.1, 1.6));
}
