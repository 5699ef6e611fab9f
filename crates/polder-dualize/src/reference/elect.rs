//! Who stands for points that are equal.

/// For each vertex the lowest input index of the points that it stands for.
///
/// `vertex_of` gives the vertex of each point, `order` the input index of each point, both by the number that the stages
/// use. It is decided at the very end: a site may be taken out and come back after its twin, so which of two equal
/// points became the vertex says nothing.
pub(crate) fn names(vertex_of: &[u32], order: &[u32]) -> Vec<u32> {
    let mut names = order.to_vec();
    for (&v, &input) in vertex_of.iter().zip(order) {
        let name = &mut names[v as usize];
        *name = (*name).min(input);
    }
    names
}

/// For each input point the input index of the vertex that stands for it.
pub(crate) fn representatives(vertex_of: &[u32], order: &[u32], names: &[u32]) -> Vec<u32> {
    let mut out = vec![0; order.len()];
    for (&v, &input) in vertex_of.iter().zip(order) {
        out[input as usize] = names[v as usize];
    }
    out
}
