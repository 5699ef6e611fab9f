//! The stage alone: two constraints walk, are inserted into a triangulation, and flips follow; two more cross.

use glam::DVec2;
use polder_constrain::{ConstrainError, reference};

fn main() -> Result<(), ConstrainError> {
    let positions: Vec<DVec2> =
        [(0., 0.), (12., 0.), (2., 3.), (5., 2.), (8., 3.), (3., -3.), (6., -2.), (9., -3.), (6., 0.)]
            .map(DVec2::from)
            .to_vec();
    // Any triangulation will do; this one is made of nothing but hull flips.
    let (mut mesh, _) = polder_flip::reference::sweep(&positions)?;

    // From vertex 0 through vertex 8 to vertex 1, and from 3 to 4.
    let constraints = [[0, 1], [3, 4]];
    let walk = reference::walk(&mesh, &positions, &constraints)?;
    println!("{walk}");

    let crossing = reference::walk(&mesh, &positions, &[[0, 1], [3, 6], [2, 7]])?;
    print!("these cross:\n{}", reference::crossings(&mesh, &positions, &crossing, 1000)?);

    let report = reference::insert(&mut mesh, &positions, &walk.sub_constraints)?;
    println!("\n{report}");
    let flips = polder_flip::reference::flip(&mut mesh, &positions)?;
    println!("{flips}\n\n{mesh}");
    Ok(())
}
