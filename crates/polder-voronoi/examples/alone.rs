//! The stage by itself: a dozen points, their grid, and the digital Voronoi diagram in letters.
//!
//! `cargo run -p polder-voronoi --example alone`
use polder_voronoi::{DVec2, Resolution, VoronoiError, reference};

fn main() -> Result<(), VoronoiError> {
    // The last point shares a pixel with the one before it: it will be missing.
    let points = [
        (0.0, 0.0),
        (9.0, 0.5),
        (18.5, 0.0),
        (4.0, 4.5),
        (13.0, 3.5),
        (0.5, 8.0),
        (9.5, 8.5),
        (18.0, 7.0),
        (4.5, 12.0),
        (13.5, 11.5),
        (18.5, 12.0),
        (13.4, 11.4),
    ]
    .map(|(x, y)| DVec2::new(x, y));

    let output = reference::diagram(&points, &Resolution::LongerSide(28).into())?;
    let (mapping, sites, counts) = (&output.mapping, &output.sites, &output.counts);

    println!("{mapping}\n{sites}\n{}\n{counts}", output.diagram.letters(sites));
    for (&point, &pixel) in sites.order.iter().zip(&sites.pixels).take(3) {
        let center = mapping.center(pixel.map(u32::from));
        println!("point {point} at {} has the pixel with center {center}", points[point as usize]);
    }
    Ok(())
}
