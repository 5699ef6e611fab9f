//! The mesh under inspection, with the edges around each vertex.

use glam::DVec2;
use polder_mesh::{NONE, next, prev};
use rayon::prelude::*;
use std::borrow::Cow;

/// Triangles, and for each vertex the half-edges that start there.
///
/// Corners are representatives of equal points, and no triangle is clockwise; a triangle that cannot be used has the
/// corner [`NONE`] three times and is met nowhere.
pub(super) struct Mesh<'a> {
    pub(super) points: &'a [DVec2],
    pub(super) triangles: Cow<'a, [[u32; 3]]>,
    /// Where the half-edges out of each vertex begin in `around`.
    starts: Vec<u32>,
    /// Half-edges by origin, then by destination, then by number: `destination << 32 | half-edge`.
    around: Vec<u64>,
}

/// A half-edge out of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Out {
    pub(super) destination: u32,
    pub(super) half_edge: u32,
}

fn unpack(entry: u64) -> Out {
    Out { destination: (entry >> 32) as u32, half_edge: entry as u32 }
}

impl<'a> Mesh<'a> {
    pub(super) fn new(points: &'a [DVec2], triangles: Cow<'a, [[u32; 3]]>) -> Self {
        let mut mesh = Self { points, triangles, starts: Vec::new(), around: Vec::new() };
        mesh.sort();
        mesh
    }

    /// A counting sort by origin, then a sort of each vertex' half-edges by destination.
    fn sort(&mut self) {
        let mut ends = vec![0u32; self.points.len() + 1];
        for &corner in self.triangles.iter().flatten().filter(|&&corner| corner != NONE) {
            ends[corner as usize] += 1;
        }
        let mut total = 0;
        for end in &mut ends {
            total += std::mem::replace(end, total);
        }
        let mut around = vec![0; total as usize];
        for (t, corners) in self.triangles.iter().enumerate().filter(|(_, corners)| corners[0] != NONE) {
            for k in 0..3 {
                let (origin, destination) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let place = &mut ends[origin as usize];
                around[*place as usize] = u64::from(destination) << 32 | (3 * t + k) as u64;
                *place += 1;
            }
        }

        // `ends[v]` now is the end of vertex v. Vertices are sorted in groups side by side.
        const GROUP: usize = 1 << 14;
        ends.pop();
        let mut groups = Vec::new();
        let mut rest = around.as_mut_slice();
        let mut begin = 0;
        for group in ends.chunks(GROUP) {
            let end = group[group.len() - 1];
            let (mine, others) = rest.split_at_mut((end - begin) as usize);
            groups.push((group, begin, mine));
            (rest, begin) = (others, end);
        }
        groups.par_iter_mut().for_each(|(ends, begin, mine)| {
            let mut from = 0;
            for &end in ends.iter() {
                let to = (end - *begin) as usize;
                mine[from..to].sort_unstable();
                from = to;
            }
        });
        drop(groups);
        ends.insert(0, 0);
        (self.starts, self.around) = (ends, around);
    }

    /// Takes triangles out.
    pub(super) fn remove(&mut self, triangles: &[u32]) {
        let all = self.triangles.to_mut();
        triangles.iter().for_each(|&t| all[t as usize] = [NONE; 3]);
        self.sort();
    }

    pub(super) fn vertices(&self) -> usize {
        self.points.len()
    }

    pub(super) fn point(&self, v: u32) -> DVec2 {
        self.points[v as usize]
    }

    /// How many half-edges start at a vertex: the number of its triangles.
    pub(super) fn degree(&self, v: u32) -> usize {
        (self.starts[v as usize + 1] - self.starts[v as usize]) as usize
    }

    fn slice(&self, v: u32) -> &[u64] {
        &self.around[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }

    /// The half-edges out of a vertex, by destination.
    pub(super) fn outgoing(&self, v: u32) -> impl ExactSizeIterator<Item = Out> + Clone + '_ {
        self.slice(v).iter().map(|&entry| unpack(entry))
    }

    /// The lowest half-edge from one vertex to another.
    pub(super) fn find(&self, from: u32, to: u32) -> Option<u32> {
        let all = self.slice(from);
        let at = if all.len() <= 16 {
            all.iter().position(|&entry| (entry >> 32) as u32 == to)?
        } else {
            all.partition_point(|&entry| ((entry >> 32) as u32) < to)
        };
        all.get(at).map(|&entry| unpack(entry)).filter(|out| out.destination == to).map(|out| out.half_edge)
    }

    pub(super) fn apex(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    pub(super) fn origin(&self, h: u32) -> u32 {
        self.apex(next(h))
    }

    pub(super) fn destination(&self, h: u32) -> u32 {
        self.apex(prev(h))
    }

    /// The half-edge on the other side, if there is a triangle.
    pub(super) fn twin(&self, h: u32) -> Option<u32> {
        self.find(self.destination(h), self.origin(h))
    }
}
