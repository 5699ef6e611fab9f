//! Stages 2 to 4 alone: what each of them makes of a few points, and how the result leads back to the input.
//!
//! `cargo run -p polder-dualize --example alone`

use polder_dualize::{DVec2, DualizeError, reference};
use polder_voronoi::{Options, Resolution};

fn main() -> Result<(), DualizeError> {
    // Points on a circle, two close together, and one of them twice.
    let mut points: Vec<DVec2> = (0..9).map(|i| DVec2::from_angle(0.7 * f64::from(i))).collect();
    points.extend([DVec2::new(0.2, 0.1), DVec2::new(0.21, 0.12), points[3]]);

    // Stage 1: the digital Voronoi diagram, on a coarse grid so that it can be looked at.
    let options = Options::from(Resolution::LongerSide(12));
    let voronoi = polder_voronoi::reference::diagram(&points, &options)?;
    let sites = &voronoi.sites;
    println!("{}", voronoi.diagram.letters(sites));

    // Stage 2: its dual, with sites at the centers of their pixels.
    let dualized = reference::dual(&voronoi.diagram, sites)?;
    println!("dualized: {dualized}");

    // Stage 3: sites move to their true positions; those that cannot are taken out.
    let centers: Vec<DVec2> =
        sites.pixels[..sites.count].iter().map(|pixel| voronoi.mapping.center(pixel.map(u32::from))).collect();
    let positions: Vec<DVec2> = sites.order.iter().map(|&i| points[i as usize]).collect();
    let shifted = reference::shift(dualized.mesh, &centers, &positions)?;
    println!("shifted: {shifted}");

    // Stage 4: these and the points that own no pixel are inserted.
    let new = reference::points_to_insert(&voronoi.diagram, sites, &shifted);
    let inserted = reference::insert(shifted.mesh, &positions, &new)?;
    println!("inserted: {inserted}");

    // Back to the input's numbering: the lowest of equal points stands for them.
    let names = inserted.names(&sites.order);
    println!("representatives: {:?}", inserted.representatives(&sites.order, &names));
    let triangles: Vec<[u32; 3]> =
        inserted.mesh.finite().map(|t| inserted.mesh.triangles[t].map(|v| names[v as usize])).collect();
    println!("triangles: {triangles:?}");
    Ok(())
}
