//! Mesh data alone: bare triangles in, canonical order, hull and digest out.
#![forbid(unsafe_code)]

use polder_mesh::{MeshError, Triangulation, VertexId};

fn main() -> Result<(), MeshError> {
    let mesh = Triangulation::from_triangles(5, &[[4, 0, 1], [1, 2, 4], [4, 2, 3], [3, 0, 4]])?;
    print!("{mesh}");
    println!("hull: {:?}", mesh.hull());
    println!("around vertex 4: {:?}", mesh.star(VertexId(4)));
    println!("digest: {}", mesh.digest());
    Ok(())
}
