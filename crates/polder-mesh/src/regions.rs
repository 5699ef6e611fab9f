//! What constrained edges divide a triangulation into.

use crate::{NONE, TriangleId, Triangulation};

/// The regions of a triangulation: two triangles are in one region if a way leads from one to the other across no
/// constrained edge.
///
/// Regions are numbered from 0 in the order of their first triangles. The *depth* of a region is the least number of
/// constrained edges that a way to it from outside the triangulation crosses: what lies open to the outside has depth
/// 0, the inside of an outline 1, a hole in it 2, an island in the hole 3. An edge counts once however many constraints
/// run along it, and a constraint that ends somewhere inside makes nothing deeper, because ways lead round it.
///
/// This is topology alone, and knows no positions.
///
/// ```
/// use polder_mesh::{Regions, TriangleId, Triangulation};
///
/// let whole = Triangulation::from_triangles(5, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 3]])?;
/// let regions = Regions::of(&whole);
/// assert_eq!((regions.count(), regions.depth(0)), (1, 0));
/// let (half, kept) = whole.filter(|t| t.0 < 2);
/// assert_eq!((half.triangles().len(), kept), (2, vec![TriangleId(0), TriangleId(1)]));
/// # Ok::<(), polder_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Regions {
    of_triangle: Vec<u32>,
    depths: Vec<u32>,
}

impl Regions {
    /// The regions of a triangulation, in linear time.
    pub fn of(triangulation: &Triangulation) -> Self {
        let neighbors = triangulation.neighbors();
        let constrained = triangulation.constrained_bits();
        let count = neighbors.len();
        let mut of_triangle = vec![NONE; count];
        let mut regions = 0;
        let mut todo = Vec::new();
        for first in 0..count {
            if of_triangle[first] != NONE {
                continue;
            }
            of_triangle[first] = regions;
            todo.push(first as u32);
            while let Some(t) = todo.pop() {
                for (k, &n) in neighbors[t as usize].iter().enumerate() {
                    if n != NONE && constrained[t as usize] >> k & 1 == 0 && of_triangle[n as usize] == NONE {
                        of_triangle[n as usize] = regions;
                        todo.push(n);
                    }
                }
            }
            regions += 1;
        }
        let depths = depths(neighbors, constrained, &of_triangle, regions as usize);
        Self { of_triangle, depths }
    }

    /// How many regions there are.
    pub fn count(&self) -> usize {
        self.depths.len()
    }

    /// The region of a triangle.
    pub fn region(&self, t: TriangleId) -> u32 {
        self.of_triangle[t.index()]
    }

    /// The region of each triangle.
    pub fn regions(&self) -> &[u32] {
        &self.of_triangle
    }

    /// The depth of a region.
    pub fn depth(&self, region: u32) -> u32 {
        self.depths[region as usize]
    }

    /// The depth of each region.
    pub fn depths(&self) -> &[u32] {
        &self.depths
    }

    /// Whether a region is inside by the even-odd rule: its depth is odd.
    pub fn is_inside(&self, region: u32) -> bool {
        self.depth(region) % 2 == 1
    }

    /// A label for each triangle: that of its region.
    pub fn labels<T>(&self, label: impl Fn(u32) -> T) -> Vec<T> {
        self.of_triangle.iter().map(|&region| label(region)).collect()
    }
}

/// The depth of each region, breadth first from the outside.
fn depths(neighbors: &[[u32; 3]], constrained: &[u8], of_triangle: &[u32], regions: usize) -> Vec<u32> {
    // The triangles of each region, so that a region is looked at once.
    let mut starts = vec![0u32; regions + 1];
    of_triangle.iter().for_each(|&region| starts[region as usize + 1] += 1);
    (0..regions).for_each(|i| starts[i + 1] += starts[i]);
    let mut next = starts.clone();
    let mut members = vec![0u32; of_triangle.len()];
    for (t, &region) in of_triangle.iter().enumerate() {
        members[next[region as usize] as usize] = t as u32;
        next[region as usize] += 1;
    }

    let mut depths = vec![NONE; regions];
    let mut level: Vec<u32> = Vec::new();
    let mut walled: Vec<u32> = Vec::new();
    for (t, row) in neighbors.iter().enumerate() {
        for k in (0..3).filter(|&k| row[k] == NONE) {
            let list = if constrained[t] >> k & 1 == 1 { &mut walled } else { &mut level };
            list.push(of_triangle[t]);
        }
    }
    // Each turn but the last gives a depth to a region; what is met again has one already.
    let mut depth = 0;
    while !level.is_empty() || !walled.is_empty() {
        let mut following = std::mem::take(&mut walled);
        for region in level {
            if depths[region as usize] != NONE {
                continue;
            }
            depths[region as usize] = depth;
            let range = starts[region as usize] as usize..starts[region as usize + 1] as usize;
            for &t in &members[range] {
                let others = neighbors[t as usize].iter().filter(|&&n| n != NONE).map(|&n| of_triangle[n as usize]);
                following.extend(others.filter(|&other| depths[other as usize] == NONE));
            }
        }
        level = following;
        depth += 1;
    }
    // A closed surface has no outside; triangles of a planar input never form one.
    depths.iter_mut().filter(|depth| **depth == NONE).for_each(|depth| *depth = 0);
    depths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Chains, GhostMesh, Parts, Slot};

    /// A ring of triangles around a middle one, all edges of the middle one constrained, and one outer edge.
    fn nested() -> Triangulation {
        let triangles = [[0, 1, 2], [0, 3, 1], [1, 4, 2], [0, 2, 5]];
        let neighbors = [[2, 3, 1], [NONE, 0, NONE], [NONE, 0, NONE], [NONE, NONE, 0]];
        let constrained = [7, 2, 2, 4];
        let slot =
            |t: usize| Some(Slot { corners: triangles[t], neighbors: neighbors[t], constrained: constrained[t] });
        let parts = Parts { representatives: (0..6).collect(), chains: Chains::default() };
        Triangulation::from_slots(4, slot, parts)
    }

    #[test]
    fn a_walled_triangle_is_a_region_of_depth_one() {
        let mesh = nested();
        let regions = Regions::of(&mesh);
        assert_eq!(regions.count(), 4);
        assert_eq!(regions.regions(), [0, 1, 2, 3]);
        assert_eq!(regions.depths(), [1, 0, 0, 0]);
        assert!(regions.is_inside(0) && !regions.is_inside(1));
        assert_eq!(regions.labels(|r| regions.is_inside(r)), [true, false, false, false]);
    }

    #[test]
    fn a_filtered_mesh_has_holes_where_triangles_were() {
        let mesh = nested();
        let (ring, kept) = mesh.filter(|t| t.0 != 0);
        assert_eq!(kept, [1, 2, 3].map(TriangleId));
        assert_eq!(ring.triangles(), &mesh.triangles()[1..]);
        assert!(ring.neighbors().iter().flatten().all(|&n| n == NONE));
        assert_eq!(ring.constrained_bits(), &mesh.constrained_bits()[1..]);
        assert_eq!(ring.representatives(), mesh.representatives());
        assert_eq!(mesh.filter(|_| true).0, mesh);
        assert!(mesh.filter(|_| false).0.triangles().is_empty());
    }

    #[test]
    fn nothing_has_no_regions() {
        let empty = Triangulation::from_mesh(&GhostMesh::default(), &[], Parts::default());
        assert_eq!(Regions::of(&empty), Regions::default());
    }
}
