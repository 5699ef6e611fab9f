//! The canonical order: each triangle starts at its smallest vertex, triangles are sorted by their corners.

use crate::{MeshError, NONE};
use rayon::prelude::*;

/// A finite triangle as a working mesh holds it: the input of the canonical order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Corners, counterclockwise, in the final numbering of vertices.
    pub corners: [u32; 3],
    /// The slot on the other side of each edge; a slot that holds no finite triangle, or [`NONE`], is outside.
    pub neighbors: [u32; 3],
    /// Bit `k` says that edge `k` is constrained.
    pub constrained: u8,
}

pub(crate) struct Canonical {
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) neighbors: Vec<[u32; 3]>,
    pub(crate) constrained: Vec<u8>,
}

/// A triangle on its way to its place: the two corners after the smallest one, its slot, its smallest corner's place.
#[derive(Clone, Copy)]
struct Entry {
    rest: [u32; 2],
    slot: u32,
    rotation: u8,
}

/// Sorts the triangles among `slots` slots: a counting sort by the smallest corner, then each small bucket by the
/// other two. The result depends on the triangles alone, not on their slots or the number of threads.
pub(crate) fn sort(vertices: usize, slots: usize, get: impl Fn(usize) -> Option<Slot> + Sync) -> Canonical {
    let smallest = |c: [u32; 3]| {
        if c[0] < c[1] && c[0] < c[2] {
            0
        } else if c[1] < c[2] {
            1
        } else {
            2
        }
    };

    let mut starts = vec![0u32; vertices + 1];
    for slot in (0..slots).filter_map(&get) {
        starts[slot.corners[smallest(slot.corners)] as usize] += 1;
    }
    let mut total = 0;
    for start in &mut starts {
        total += std::mem::replace(start, total);
    }

    let empty = Entry { rest: [0; 2], slot: NONE, rotation: 0 };
    let mut entries = vec![empty; total as usize];
    for t in 0..slots {
        if let Some(slot) = get(t) {
            let r = smallest(slot.corners);
            let c = slot.corners;
            let place = &mut starts[c[r] as usize];
            entries[*place as usize] =
                Entry { rest: [c[(r + 1) % 3], c[(r + 2) % 3]], slot: t as u32, rotation: r as u8 };
            *place += 1;
        }
    }

    // `starts[v]` has moved to the end of bucket v. Buckets are sorted in place, groups of vertices side by side.
    const GROUP: usize = 1 << 14;
    let ends = &starts[..vertices];
    let mut groups = Vec::new();
    let mut rest = entries.as_mut_slice();
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
            mine[from..to].sort_unstable_by_key(|e| e.rest);
            from = to;
        }
    });
    drop(groups);

    let mut place = vec![NONE; slots];
    for (i, entry) in entries.iter().enumerate() {
        place[entry.slot as usize] = i as u32;
    }
    let mut out = Canonical {
        triangles: vec![[0; 3]; entries.len()],
        neighbors: vec![[NONE; 3]; entries.len()],
        constrained: vec![0; entries.len()],
    };
    let parts = (&entries, &mut out.triangles, &mut out.neighbors, &mut out.constrained);
    parts.into_par_iter().with_min_len(4096).for_each(|(entry, corners, neighbors, constrained)| {
        let Some(slot) = get(entry.slot as usize) else { return };
        for (k, neighbor) in neighbors.iter_mut().enumerate() {
            let from = (k + entry.rotation as usize) % 3;
            corners[k] = slot.corners[from];
            *neighbor = place.get(slot.neighbors[from] as usize).copied().unwrap_or(NONE);
            *constrained |= (slot.constrained >> from & 1) << k;
        }
    });
    out
}

/// The triangle on the other side of each edge, found by sorting the edges.
pub(crate) fn neighbors_of(points: usize, triangles: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, MeshError> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        if corners.iter().any(|&v| v as usize >= points) {
            return Err(MeshError::Broken { triangle, what: "a corner that is no point" });
        }
        let [a, b, c] = *corners;
        if a == b || b == c || c == a {
            return Err(MeshError::Broken { triangle, what: "a vertex twice" });
        }
        for k in 0..3 {
            let (from, to) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            edges.push((from.min(to), from.max(to), from > to, 3 * triangle as u32 + k as u32));
        }
    }
    edges.par_sort_unstable();
    let mut neighbors = vec![[NONE; 3]; triangles.len()];
    for pair in edges.windows(2) {
        let [(a, b, side, h), (c, d, other, g)] = [pair[0], pair[1]];
        if (a, b) != (c, d) {
            continue;
        }
        if side == other {
            return Err(MeshError::Broken {
                triangle: (h.max(g) / 3) as usize,
                what: "an edge with two triangles on one side",
            });
        }
        neighbors[h as usize / 3][h as usize % 3] = g / 3;
        neighbors[g as usize / 3][g as usize % 3] = h / 3;
    }
    Ok(neighbors)
}
