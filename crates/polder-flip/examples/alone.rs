//! The stage alone: from bare points to their Delaunay triangulation, by flips and nothing else.

use glam::DVec2;
use polder_flip::{FlipError, reference};

fn main() -> Result<(), FlipError> {
    let positions: Vec<DVec2> =
        [(0.0, 0.0), (2.0, 3.0), (3.0, -3.0), (4.0, 2.0), (6.0, 0.0), (3.0, 1.0)].map(DVec2::from).to_vec();
    let (mut mesh, closing) = reference::sweep(&positions)?;
    println!("some triangulation ({closing}):\n{mesh}");
    let report = reference::flip(&mut mesh, &positions)?;
    println!("the Delaunay triangulation ({report}):\n{mesh}");
    Ok(())
}
