//! The canonical order: each triangle starts at its smallest vertex, triangles are sorted by their corners.

use crate::{MeshError, NONE};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

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

/// A triangle on its way to its place: corners from the smallest on, neighbors still as slots.
#[derive(Clone, Copy)]
struct Entry {
    corners: [u32; 3],
    neighbors: [u32; 3],
    slot: u32,
    constrained: u8,
}

impl Entry {
    const EMPTY: Self = Self { corners: [0; 3], neighbors: [NONE; 3], slot: 0, constrained: 0 };

    fn of(t: usize, slot: Slot) -> Self {
        let [a, b, c] = slot.corners;
        let turn = |x: [u32; 3], by: usize| [x[by % 3], x[(by + 1) % 3], x[(by + 2) % 3]];
        let by = if a < b && a < c { 0 } else { 1 + usize::from(c < b) };
        let bits = slot.constrained & 7;
        let constrained = (bits >> by | bits << (3 - by)) & 7;
        Self { corners: turn(slot.corners, by), neighbors: turn(slot.neighbors, by), slot: t as u32, constrained }
    }
}

/// Smallest corners are sorted apart into parts of at least this many vertices (as a power of two), small enough for
/// the cache, and into at most this many parts, few enough to be written to side by side.
const PART: u32 = 12;
const PARTS: u32 = 9;
/// Slots of one piece of work.
const PIECE: usize = 1 << 16;

/// Sorts the triangles among `slots` slots: apart by their smallest corner, coarsely; then each part by itself.
///
/// Memory is the bottleneck, so that each triangle is read once in the order of the slots, written once to its part,
/// and written once to its place. The result depends on the triangles alone, not on their slots or the number of
/// threads.
pub(crate) fn sort(vertices: usize, slots: usize, get: impl Fn(usize) -> Option<Slot> + Sync) -> Canonical {
    let shift = PART.max(usize::BITS.saturating_sub(vertices.leading_zeros() + PARTS));
    let parts = (vertices >> shift) + 1;
    let (mut entries, ends) = scatter(slots, parts, shift, get);

    // Where each triangle goes. Every slot is written at most once, by the part that its triangle is in.
    let place: Vec<AtomicU32> = (0..slots).into_par_iter().with_min_len(PIECE).map(|_| AtomicU32::new(NONE)).collect();
    let mut ranges = Vec::with_capacity(parts);
    let mut rest = entries.as_mut_slice();
    let mut begin = 0;
    for &end in &ends {
        let (mine, others) = rest.split_at_mut(end - begin);
        ranges.push((begin, mine));
        (rest, begin) = (others, end);
    }
    let sorted = |(i, (begin, mine)): (usize, (usize, &mut [Entry]))| {
        let order = sort_part(mine, i << shift, 1 << shift);
        for (i, &from) in order.iter().enumerate() {
            place[mine[from as usize].slot as usize].store((begin + i) as u32, Relaxed);
        }
        order
    };
    let orders: Vec<Vec<u32>> = ranges.into_par_iter().enumerate().map(sorted).collect();

    let mut out = Canonical {
        triangles: vec![[0; 3]; entries.len()],
        neighbors: vec![[NONE; 3]; entries.len()],
        constrained: vec![0; entries.len()],
    };
    let mut rest = (out.triangles.as_mut_slice(), out.neighbors.as_mut_slice(), out.constrained.as_mut_slice());
    let mut pieces = Vec::with_capacity(parts);
    let mut begin = 0;
    for (order, &end) in orders.iter().zip(&ends) {
        let length = end - begin;
        let (triangles, neighbors, constrained) =
            (rest.0.split_at_mut(length), rest.1.split_at_mut(length), rest.2.split_at_mut(length));
        pieces.push((&entries[begin..end], order, triangles.0, neighbors.0, constrained.0));
        rest = (triangles.1, neighbors.1, constrained.1);
        begin = end;
    }
    pieces.into_par_iter().for_each(|(mine, order, triangles, neighbors, constrained)| {
        for (i, &from) in order.iter().enumerate() {
            let entry = &mine[from as usize];
            triangles[i] = entry.corners;
            constrained[i] = entry.constrained;
            neighbors[i] = entry.neighbors.map(|t| place.get(t as usize).map_or(NONE, |place| place.load(Relaxed)));
        }
    });
    out
}

/// Writes each triangle to its part. Returns all entries, part after part, and the end of each part.
fn scatter(
    slots: usize,
    parts: usize,
    shift: u32,
    get: impl Fn(usize) -> Option<Slot> + Sync,
) -> (Vec<Entry>, Vec<usize>) {
    // One column of counts a piece of the slots, so that pieces can be written side by side.
    let pieces: Vec<_> = (0..slots).step_by(PIECE).map(|from| from..slots.min(from + PIECE)).collect();
    let part_of = |slot: &Slot| (slot.corners[0].min(slot.corners[1]).min(slot.corners[2]) >> shift) as usize;
    let count = |piece: &Range<usize>| {
        let mut counts = vec![0u32; parts];
        piece.clone().filter_map(&get).for_each(|slot| counts[part_of(&slot)] += 1);
        counts
    };
    let counts: Vec<Vec<u32>> = pieces.par_iter().map(count).collect();
    let total: usize = counts.iter().flatten().map(|&c| c as usize).sum();

    let mut entries = vec![Entry::EMPTY; total];
    let mut ends = Vec::with_capacity(parts);
    let mut targets: Vec<Vec<&mut [Entry]>> = pieces.iter().map(|_| Vec::with_capacity(parts)).collect();
    let mut rest = entries.as_mut_slice();
    for part in 0..parts {
        for (target, counts) in targets.iter_mut().zip(&counts) {
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(counts[part] as usize);
            target.push(mine);
            rest = others;
        }
        ends.push(total - rest.len());
    }
    pieces.into_par_iter().zip(targets).for_each(|(piece, mut targets)| {
        let mut next = vec![0u32; parts];
        for t in piece {
            if let Some(slot) = get(t) {
                let part = part_of(&slot);
                targets[part][next[part] as usize] = Entry::of(t, slot);
                next[part] += 1;
            }
        }
    });
    (entries, ends)
}

/// The order of the entries of one part, whose smallest corners are `first..first + vertices`: a counting sort by the
/// smallest corner, then each small bucket by the other two.
fn sort_part(entries: &[Entry], first: usize, vertices: usize) -> Vec<u32> {
    if entries.is_empty() {
        return Vec::new();
    }
    let mut starts = vec![0u32; vertices];
    for entry in entries {
        starts[entry.corners[0] as usize - first] += 1;
    }
    let mut total = 0;
    for start in &mut starts {
        total += std::mem::replace(start, total);
    }
    let mut order = vec![0u32; entries.len()];
    for (i, entry) in entries.iter().enumerate() {
        let place = &mut starts[entry.corners[0] as usize - first];
        order[*place as usize] = i as u32;
        *place += 1;
    }
    // Each start has moved to the end of its bucket.
    let key = |&i: &u32| entries[i as usize].corners;
    let mut from = 0;
    for end in starts {
        let bucket = &mut order[from as usize..end as usize];
        if bucket.len() > 1 {
            bucket.sort_unstable_by_key(key);
        }
        from = end;
    }
    order
}

/// Checks that arrays are in canonical order; see [`Triangulation::from_canonical`](crate::Triangulation::from_canonical).
pub(crate) fn check(
    points: usize,
    triangles: &[[u32; 3]],
    neighbors: &[[u32; 3]],
    constrained: &[u8],
) -> Result<(), MeshError> {
    let count = triangles.len();
    if neighbors.len() != count || constrained.len() != count {
        let triangle = count.min(neighbors.len()).min(constrained.len());
        return Err(MeshError::Broken { triangle, what: "the arrays of the mesh differ in length" });
    }
    let fault = |t: usize| {
        let [a, b, c] = triangles[t];
        if a as usize >= points || b as usize >= points || c as usize >= points {
            return Some("a corner that is no point");
        }
        if a >= b || a >= c {
            return Some("a first corner that is not the smallest");
        }
        if t > 0 && triangles[t - 1] >= triangles[t] {
            return Some("a triangle out of order");
        }
        let exists = |n: &u32| *n == NONE || (*n as usize) < count;
        (!neighbors[t].iter().all(exists)).then_some("a neighbor that does not exist")
    };
    // Piece by piece: without a branch, since no processor guesses corners; one after the other if something is wrong.
    let (points, limit) = (u32::try_from(points).unwrap_or(NONE), u32::try_from(count).unwrap_or(NONE));
    let key = |[a, b, _]: [u32; 3]| u64::from(a) << 32 | u64::from(b);
    let sound = |piece: Range<usize>| {
        let (mut before, mut last) = match piece.start.checked_sub(1) {
            Some(t) => (key(triangles[t]), triangles[t][2]),
            None => (0, 0),
        };
        let mut sound = true;
        for (&[a, b, c], across) in triangles[piece.clone()].iter().zip(&neighbors[piece]) {
            let this = key([a, b, c]);
            sound &= (a < b) & (a < c) & (b < points) & (c < points);
            sound &= (before < this) | ((before == this) & (last < c));
            // No triangle is one that exists, counted from one.
            sound &= across.iter().fold(true, |all, n| all & (n.wrapping_add(1) <= limit));
            (before, last) = (this, c);
        }
        sound
    };
    let faulty = |i: usize| {
        let mut piece = i * PIECE..count.min((i + 1) * PIECE);
        if sound(piece.clone()) { None } else { piece.find_map(|t| Some((t, fault(t)?))) }
    };
    match (0..count.div_ceil(PIECE)).into_par_iter().find_map_first(faulty) {
        Some((triangle, what)) => Err(MeshError::Broken { triangle, what }),
        None => Ok(()),
    }
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
