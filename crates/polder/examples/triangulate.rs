//! The facade alone: points and a constraint in; triangles, report and an exact check out.
#![forbid(unsafe_code)]

use polder::{DVec2, Error, Options, Pslg, triangulate, verify};

fn main() -> Result<(), Error> {
    let points = (0..9).map(|i| DVec2::new(f64::from(i % 3), f64::from(i / 3)));
    let pslg = Pslg::new(points.collect(), vec![[0, 5]])?;
    let output = triangulate(&pslg, &Options::default())?;
    print!("{}", output.triangulation);
    println!("{} triangles by {}", output.report.triangles, output.report.way);
    println!("{}", verify::check_triangulation(&pslg, &output.triangulation));
    Ok(())
}
