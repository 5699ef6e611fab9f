//! The kernels of constraints that are cut at vertices.

use polder_mesh::GhostMesh;

/// For every vertex a half-edge that leaves it, or [`NONE`](polder_mesh::NONE), and how many do. Any half-edge would do:
/// nothing of a result depends on which it is.
pub fn find_spokes(mesh: &GhostMesh, vertices: usize) -> (Vec<u32>, Vec<u32>) {
    let mut degrees = vec![0; vertices];
    for &v in mesh.triangles.iter().flatten() {
        if let Some(degree) = degrees.get_mut(v as usize) {
            *degree += 1;
        }
    }
    (mesh.half_edge_of_vertex(vertices), degrees)
}
