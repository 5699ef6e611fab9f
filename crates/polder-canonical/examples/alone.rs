//! Five points, two of them equal, in a mesh as the stages leave it; then in canonical order.

use polder_canonical::reference::{canonical, certify};
use polder_flip::reference::{flip, sweep};
use polder_mesh::DVec2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let positions = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0), (5.0, 4.0)].map(DVec2::from);
    let (mut mesh, _) = sweep(&positions)?;
    flip(&mut mesh, &positions)?;
    println!("working mesh:\n{mesh}");
    certify(&mesh, &positions, 4)?;

    // Vertex 3 is point 3 of the stages' numbering, and point 4 equals it; their input indices are 3 and 0.
    let result = canonical(&mesh, &[0, 1, 2, 3, 3], &[4, 1, 2, 3, 0]);
    println!("canonical: {:?}", result.triangles);
    println!("neighbors: {:?}", result.neighbors);
    println!("representatives: {:?}", result.representatives);
    Ok(())
}
