//! One function for each kernel, of its name. Where the order of arrival decides on a device, the order of slots does here.

use polder_mesh::{GhostMesh, NONE};

/// The name of each vertex and the representative of each input point, as if no two points were equal.
pub fn start_names(order: &[u32]) -> (Vec<u32>, Vec<u32>) {
    (order.to_vec(), (0..order.len() as u32).collect())
}

/// Gives each vertex the lowest input index of the points that are equal to it.
pub fn elect_names(vertex_of: &[u32], order: &[u32], names: &mut [u32]) {
    for (i, (&v, &input)) in vertex_of.iter().zip(order).enumerate() {
        if v as usize != i {
            names[v as usize] = names[v as usize].min(input);
        }
    }
}

/// Writes the representatives of the points that do not stand for themselves, and counts the points that are no vertices.
pub fn name_points(vertex_of: &[u32], order: &[u32], names: &[u32], representatives: &mut [u32]) -> u32 {
    let mut duplicates = 0;
    for (i, (&v, &input)) in vertex_of.iter().zip(order).enumerate() {
        let name = names[v as usize];
        if name != input {
            representatives[input as usize] = name;
        }
        duplicates += u32::from(v as usize != i);
    }
    duplicates
}

fn is_listed(mesh: &GhostMesh, t: usize) -> bool {
    mesh.is_finite(t)
}

/// Which corner has the smallest name.
fn first_corner(corners: [u32; 3], names: &[u32]) -> usize {
    let [a, b, c] = corners.map(|v| names[v as usize]);
    if a < b && a < c { 0 } else { 1 + usize::from(c <= b) }
}

/// For each slot its place in the list of its smallest vertex, times four, and which corner that is; how long each list is,
/// with a zero behind the last; how many ghost triangles there are.
pub fn count_triangles(mesh: &GhostMesh, names: &[u32]) -> (Vec<u32>, Vec<u32>, u32) {
    let mut counts = vec![0; names.len() + 1];
    let place = |(t, &corners): (usize, &[u32; 3])| {
        if !is_listed(mesh, t) {
            return NONE;
        }
        let k = first_corner(corners, names);
        let count = &mut counts[corners[k] as usize];
        *count += 1;
        (*count - 1) << 2 | k as u32
    };
    let places = mesh.triangles.iter().enumerate().map(place).collect();
    let ghosts = (0..mesh.slots()).filter(|&t| !mesh.is_deleted(t) && !is_listed(mesh, t)).count();
    (places, counts, ghosts as u32)
}

/// The lengths of the lists, by name.
pub fn spread_counts(starts: &[u32], names: &[u32], named_counts: &mut [u32]) {
    for (v, &name) in names.iter().enumerate() {
        let found = starts[v + 1] - starts[v];
        if found != 0 {
            named_counts[name as usize] = found;
        }
    }
}

/// The lists, one behind the other: for each triangle the half-edge opposite its smallest vertex; and the name of the
/// corner behind that one.
pub fn list_triangles(mesh: &GhostMesh, names: &[u32], places: &[u32], starts: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let total = starts.last().copied().unwrap_or(0) as usize;
    let (mut list, mut keys) = (vec![NONE; total], vec![NONE; total]);
    for (t, &place) in places.iter().enumerate().filter(|(_, place)| **place != NONE) {
        let k = place as usize & 3;
        let p = (starts[mesh.triangles[t][k] as usize] + (place >> 2)) as usize;
        list[p] = (3 * t + k) as u32;
        keys[p] = names[mesh.triangles[t][(k + 1) % 3] as usize];
    }
    (list, keys)
}

/// Lists and where they begin.
#[derive(Clone, Copy, Debug)]
pub struct Lists<'a> {
    /// By vertex.
    pub starts: &'a [u32],
    /// By name.
    pub named_starts: &'a [u32],
    /// The half-edges.
    pub list: &'a [u32],
    /// The names of the second corners.
    pub keys: &'a [u32],
}

impl Lists<'_> {
    fn range(&self, v: u32) -> std::ops::Range<usize> {
        self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize
    }
}

/// Replaces the places in lists of up to `longest` triangles by canonical places; returns the vertices of longer ones.
pub fn place_triangles(
    mesh: &GhostMesh,
    names: &[u32],
    lists: Lists<'_>,
    longest: usize,
    places: &mut [u32],
) -> Vec<u32> {
    let mut long = Vec::new();
    for v in 0..names.len() as u32 {
        let range = lists.range(v);
        if range.len() > longest {
            long.push(v);
            continue;
        }
        for p in range.clone() {
            debug_assert_eq!(mesh.apex(lists.list[p]), v);
            let rank = lists.keys[range.clone()].iter().filter(|&&key| key < lists.keys[p]).count();
            places[lists.list[p] as usize / 3] = lists.named_starts[names[v as usize] as usize] + rank as u32;
        }
    }
    long
}

/// The same for the lists of some vertices.
pub fn sort_long(long: &[u32], names: &[u32], lists: Lists<'_>, places: &mut [u32]) {
    for &v in long {
        let range = lists.range(v);
        let mut order: Vec<usize> = range.collect();
        order.sort_unstable_by_key(|&p| lists.keys[p]);
        for (rank, p) in order.into_iter().enumerate() {
            places[lists.list[p] as usize / 3] = lists.named_starts[names[v as usize] as usize] + rank as u32;
        }
    }
}

/// Triangles, neighbors and constrained bits in canonical order.
pub fn write_triangles(
    mesh: &GhostMesh,
    names: &[u32],
    list: &[u32],
    keys: &[u32],
    places: &[u32],
) -> (Vec<[u32; 3]>, Vec<[u32; 3]>, Vec<u8>) {
    let (mut triangles, mut neighbors) = (vec![[0; 3]; list.len()], vec![[NONE; 3]; list.len()]);
    let mut constrained = vec![0; list.len()];
    for (&h, &key) in list.iter().zip(keys) {
        let (t, k) = ((h / 3) as usize, (h % 3) as usize);
        let place = places[t] as usize;
        let corners = [k, (k + 1) % 3, (k + 2) % 3].map(|k| names[mesh.triangles[t][k] as usize]);
        debug_assert_eq!(corners[1], key);
        triangles[place] = corners;
        let edges = [k, (k + 1) % 3, (k + 2) % 3].map(|k| (3 * t + k) as u32);
        neighbors[place] = edges.map(|edge| places[mesh.twin(edge) as usize / 3]);
        constrained[place] = (0..3).map(|j| u8::from(mesh.is_constrained(edges[j])) << j).sum();
    }
    (triangles, neighbors, constrained)
}

/// Renames the vertices along constraints, whose chains begin at `starts`; returns how many chains have more than two.
pub fn name_chains(names: &[u32], starts: &[u32], chains: &mut [u32]) -> u32 {
    for v in chains {
        *v = names.get(*v as usize).copied().unwrap_or(NONE);
    }
    starts.windows(2).filter(|w| w[1] - w[0] > 2).count() as u32
}

/// How many edges of a result are constrained.
pub fn count_constrained(constrained: &[u8], neighbors: &[[u32; 3]]) -> u32 {
    let in_lower = |(t, (&bits, row)): (u32, (&u8, &[u32; 3]))| {
        (0..3).filter(|&k| bits >> k & 1 == 1 && row[k] > t).count() as u32
    };
    (0..).zip(constrained.iter().zip(neighbors)).map(in_lower).sum()
}
