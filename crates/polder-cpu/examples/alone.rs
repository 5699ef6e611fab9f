//! The CPU backend alone: points and a constraint in, the text form of the triangulation out.
#![forbid(unsafe_code)]

use polder_cpu::{CpuError, Delaunay};
use polder_mesh::{DVec2, Monitor};

fn main() -> Result<(), CpuError> {
    let points: Vec<_> = (0..12).map(|i| DVec2::new(f64::from(i * 5 % 12), f64::from(i * 7 % 11))).collect();
    let mut delaunay = Delaunay::new(&points, Monitor::default())?;
    let (chains, counts) = delaunay.constrain(&[[0, 7]], Monitor::default())?;
    print!("{}", delaunay.finish(chains));
    println!("{} triangles crossed, {} flips", counts.crossed_triangles, counts.flips);
    Ok(())
}
