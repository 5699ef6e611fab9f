//! Delaunay triangulation by divide and conquer.
//!
//! Guibas, Stolfi 1985 (the merge); Dwyer 1987 (cuts along both axes). Steps:
//!
//! 1. The points lie in Morton order, so that a run of them is split where the highest bit changes in which its keys
//!    differ: a vertical or a horizontal cut. Runs of equal keys are in kd-order: split at the middle, across the
//!    longer side of their bounding box.
//! 2. Each half is triangulated, side by side in threads while it is large.
//! 3. Merge: find the lower common tangent; join the two meshes along it; let the bubble rise: the next point is the
//!    candidate, left or right, whose circle through the base's ends holds no other. Hull edges that the circle
//!    forbids go first.
//!
//! Departures:
//! - Meshes are closed by ghost triangles, and every step of the merge is a flip of an edge that meets the ghost
//!   vertex. `n` vertices always have exactly `2n - 2` triangles, ghosts included, also where all are on one line. So
//!   the run `lo..hi` of vertices owns the triangles `2lo..2hi - 2`, a merge adds two in the gap between its
//!   halves, and nothing is ever allocated or freed.
//! - In-circle ties are broken canonically, so the result is the canonical triangulation at once.
//!
//! A ghost triangle keeps the ghost vertex at corner 2: its corners are `u, v, GHOST` for the hull edge from `v` to
//! `u` (the hull counterclockwise), its link 1 leads to the next hull edge's ghost and its link 0 to the previous one's.

use crate::mesh::{NONE, Slab, Tri, k, next, prev};
use crate::order::{Axis, Order};
use glam::DVec2;
use polder_mesh::{Cancelled, GHOST, Monitor};
use polder_predicates::{Sign, incircle_canonical, orient2d};
use std::sync::atomic::{AtomicU64, Ordering};

/// Runs shorter than this are not split between threads.
const PARALLEL: usize = 1 << 13;

/// What every part of the recursion sees.
struct Build<'a> {
    points: &'a [DVec2],
    keys: &'a [u32],
    monitor: Monitor<'a>,
    done: AtomicU64,
}

/// The triangles of the canonical Delaunay triangulation of points in Morton order; `2n - 2` of them.
pub(crate) fn delaunay(order: &Order, monitor: Monitor<'_>) -> Result<Vec<Tri>, Cancelled> {
    let n = order.points.len();
    let mut tris = vec![Tri::EMPTY; (2 * n).saturating_sub(2)];
    if n >= 2 {
        let build = Build { points: &order.points, keys: &order.keys, monitor, done: AtomicU64::new(0) };
        build.run(&mut Slab { tris: &mut tris, base: 0 }, 0, n)?;
    }
    Ok(tris)
}

impl Build<'_> {
    /// Triangulates the vertices `lo..hi`; the slab holds the triangles `2lo..2hi - 2`. Returns a ghost, or [`NONE`] for
    /// a single vertex.
    fn run(&self, slab: &mut Slab<'_>, lo: usize, hi: usize) -> Result<u32, Cancelled> {
        match hi - lo {
            1 => return Ok(NONE),
            2 => return Ok(edge(slab, lo as u32)),
            _ => {}
        }
        let (mid, axis) = crate::order::split(self.points, self.keys, lo, hi);
        let gap = 2 * mid as u32 - 2;
        let (left, rest) = slab.tris.split_at_mut((gap - slab.base) as usize);
        let mut left = Slab { tris: left, base: slab.base };
        let mut right = Slab { tris: &mut rest[2..], base: gap + 2 };
        let (left, right) = if hi - lo >= PARALLEL {
            let (left, right) = rayon::join(|| self.run(&mut left, lo, mid), || self.run(&mut right, mid, hi));
            let done = self.done.fetch_add(1, Ordering::Relaxed);
            self.monitor.step("delaunay", done, (2 * self.points.len() / PARALLEL) as u64)?;
            (left?, right?)
        } else {
            (self.run(&mut left, lo, mid)?, self.run(&mut right, mid, hi)?)
        };
        let left = if left == NONE {
            Side::Vertex(lo as u32)
        } else {
            Side::Ghost(extreme(self.points, slab, left, axis, true))
        };
        let right = if right == NONE {
            Side::Vertex(mid as u32)
        } else {
            Side::Ghost(extreme(self.points, slab, right, axis, false))
        };
        let seam = join(self.points, slab, gap, left, right);
        Ok(rise(self.points, slab, seam))
    }
}

/// One half at the start of a merge: a single vertex, or the ghost of the hull edge that starts at its extreme vertex.
#[derive(Clone, Copy)]
enum Side {
    Vertex(u32),
    Ghost(u32),
}

impl Side {
    fn vertex(self, slab: &Slab<'_>) -> u32 {
        match self {
            Self::Vertex(v) => v,
            Self::Ghost(g) => slab.tri(g).v[1],
        }
    }
}

/// Two vertices: one edge between two ghosts.
fn edge(slab: &mut Slab<'_>, a: u32) -> u32 {
    let (b, t) = (a + 1, slab.base);
    slab.tris[0] = Tri { v: [b, a, GHOST, 0], n: [4 * (t + 1) + 1, 4 * (t + 1), 4 * (t + 1) + 2, NONE] };
    slab.tris[1] = Tri { v: [a, b, GHOST, 0], n: [4 * t + 1, 4 * t, 4 * t + 2, NONE] };
    t
}

#[inline(always)]
fn ring_next(slab: &Slab<'_>, ghost: u32) -> u32 {
    slab.tri(ghost).n[1] >> 2
}

#[inline(always)]
fn ring_prev(slab: &Slab<'_>, ghost: u32) -> u32 {
    slab.tri(ghost).n[0] >> 2
}

/// Walks round the hull to the vertex that is extreme across the cut: the last one in the axis' order, or the first.
/// The order is strict and the hull convex, so that it rises and falls once around.
fn extreme(points: &[DVec2], slab: &Slab<'_>, ghost: u32, axis: Axis, last: bool) -> u32 {
    let better = |g: u32, h: u32| {
        let (p, q) = (points[slab.tri(g).v[1] as usize], points[slab.tri(h).v[1] as usize]);
        if last { axis.less(q, p) } else { axis.less(p, q) }
    };
    let mut best = ghost;
    for step in [ring_next, ring_prev] {
        loop {
            let candidate = step(slab, best);
            if !better(candidate, best) {
                break;
            }
            best = candidate;
        }
        if best != ghost {
            break;
        }
    }
    best
}

/// Finds the lower common tangent and joins the two hulls along it. Returns the ghost on its upper side, whose hull
/// edge runs from the right end to the left one.
fn join(points: &[DVec2], slab: &mut Slab<'_>, gap: u32, mut left: Side, mut right: Side) -> u32 {
    let at = |v: u32| points[v as usize];
    let (mut l, mut r) = (left.vertex(slab), right.vertex(slab));
    loop {
        let mut moved = false;
        if let Side::Ghost(g) = &mut left {
            loop {
                let candidate = ring_prev(slab, *g);
                let v = slab.tri(candidate).v[1];
                if orient2d(at(l), at(r), at(v)) != Sign::Negative {
                    break;
                }
                (*g, l, moved) = (candidate, v, true);
            }
        }
        if let Side::Ghost(g) = &mut right {
            loop {
                let candidate = ring_next(slab, *g);
                let v = slab.tri(candidate).v[1];
                if orient2d(at(l), at(r), at(v)) != Sign::Negative {
                    break;
                }
                (*g, r, moved) = (candidate, v, true);
            }
        }
        if !moved {
            break;
        }
    }

    let (below, above) = (gap, gap + 1);
    *slab.tri_mut(below) = Tri { v: [r, l, GHOST, 0], n: [NONE, NONE, 4 * above + 2, NONE] };
    *slab.tri_mut(above) = Tri { v: [l, r, GHOST, 0], n: [NONE, NONE, 4 * below + 2, NONE] };
    match left {
        Side::Vertex(_) => slab.link(4 * below, 4 * above + 1),
        Side::Ghost(g) => {
            let before = ring_prev(slab, g);
            slab.link(4 * below, 4 * before + 1);
            slab.link(4 * above + 1, 4 * g);
        }
    }
    match right {
        Side::Vertex(_) => slab.link(4 * below + 1, 4 * above),
        Side::Ghost(g) => {
            let before = ring_prev(slab, g);
            slab.link(4 * above, 4 * before + 1);
            slab.link(4 * below + 1, 4 * g);
        }
    }
    above
}

/// Lets the bubble rise from the lower tangent to the upper one. Returns the upper tangent's ghost.
fn rise(points: &[DVec2], slab: &mut Slab<'_>, mut seam: u32) -> u32 {
    let at = |v: u32| points[v as usize];
    let [mut l, mut r, ..] = slab.tri(seam).v;
    let (mut pl, mut pr) = (at(l), at(r));
    loop {
        let left = candidate::<true>(points, slab, seam, pl, pr);
        let right = candidate::<false>(points, slab, seam, pl, pr);
        let nearer = |a: u32, b: u32| incircle_canonical(pl, pr, at(a), at(b)) != Sign::Positive;
        match (left, right) {
            (Some((ghost, a)), right) if right.is_none_or(|(_, b)| nearer(a, b)) => {
                seam = close_left(slab, seam, ghost, r);
                (l, pl) = (a, at(a));
            }
            (_, Some((ghost, b))) => {
                seam = close_right(slab, seam, ghost, l);
                (r, pr) = (b, at(b));
            }
            (_, None) => return seam,
        }
    }
}

/// The candidate on one side, once the hull edges that its circle forbids are gone: its ghost and vertex.
#[inline(always)]
fn candidate<const LEFT: bool>(
    points: &[DVec2],
    slab: &mut Slab<'_>,
    seam: u32,
    pl: DVec2,
    pr: DVec2,
) -> Option<(u32, u32)> {
    let mut ghost = if LEFT { ring_next(slab, seam) } else { ring_prev(slab, seam) };
    let mut vertex = slab.tri(ghost).v[usize::from(!LEFT)];
    let mut p = points[vertex as usize];
    if orient2d(pl, pr, p) != Sign::Positive {
        return None;
    }
    loop {
        let inner = slab.tri(ghost).n[2];
        let behind = slab.apex(inner);
        if behind == GHOST || incircle_canonical(pl, pr, p, points[behind as usize]) != Sign::Positive {
            return Some((ghost, vertex));
        }
        open(slab, ghost, inner);
        // Of the two new hull edges the ghost keeps the later one: the one at the right end of the base.
        if LEFT {
            ghost = inner >> 2;
        }
        (vertex, p) = (behind, points[behind as usize]);
    }
}

/// Removes the hull edge `vu` of a ghost: the triangle behind it, with apex `w`, opens. The ghost keeps `wu`, the
/// triangle's slot becomes the ghost of `vw`.
#[inline(always)]
fn open(slab: &mut Slab<'_>, ghost: u32, inner: u32) {
    let t = inner >> 2;
    let tri = *slab.tri(t);
    let [_, v, ..] = slab.tri(ghost).v;
    let w = tri.v[k(inner)];
    let behind_uw = tri.n[k(next(inner))];
    let behind_wv = tri.n[k(prev(inner))];
    let before = slab.tri(ghost).n[0];
    {
        let g = slab.tri_mut(ghost);
        g.v[1] = w;
        g.n[0] = 4 * t + 1;
        g.n[2] = behind_uw;
    }
    *slab.tri_mut(t) = Tri { v: [w, v, GHOST, 0], n: [before, 4 * ghost, behind_wv, NONE] };
    slab.set_twin(behind_uw, 4 * ghost + 2);
    slab.set_twin(behind_wv, 4 * t + 2);
    slab.set_twin(before, 4 * t);
}

/// Closes the corner at the left end of the base: the seam's slot becomes the triangle, the left ghost the new seam.
#[inline(always)]
fn close_left(slab: &mut Slab<'_>, seam: u32, ghost: u32, r: u32) -> u32 {
    let vertex = slab.tri(ghost).v[0];
    let inner = slab.tri(ghost).n[2];
    let before = slab.tri(seam).n[0];
    {
        let s = slab.tri_mut(seam);
        s.v[2] = vertex;
        s.n[0] = 4 * ghost + 2;
        s.n[1] = inner;
    }
    {
        let g = slab.tri_mut(ghost);
        g.v[1] = r;
        g.n[0] = before;
        g.n[2] = 4 * seam;
    }
    slab.set_twin(inner, 4 * seam + 1);
    slab.set_twin(before, 4 * ghost);
    ghost
}

/// As [`close_left`], mirrored.
#[inline(always)]
fn close_right(slab: &mut Slab<'_>, seam: u32, ghost: u32, l: u32) -> u32 {
    let vertex = slab.tri(ghost).v[1];
    let inner = slab.tri(ghost).n[2];
    let after = slab.tri(seam).n[1];
    {
        let s = slab.tri_mut(seam);
        s.v[2] = vertex;
        s.n[0] = inner;
        s.n[1] = 4 * ghost + 2;
    }
    {
        let g = slab.tri_mut(ghost);
        g.v[0] = l;
        g.n[1] = after;
        g.n[2] = 4 * seam + 1;
    }
    slab.set_twin(inner, 4 * seam);
    slab.set_twin(after, 4 * ghost + 1);
    ghost
}
