//! The kernels of constraints that are cut at vertices.
//!
//! *Items* are the constraints, and behind them the later [pieces](Piece) of long ones.

use crate::gpu::pieces::Grid;
use crate::reference::fan::{Departure, ahead, depart_by_turning, enter, leave};
use glam::DVec2;
use polder_flip::priority;
use polder_mesh::{GhostMesh, NONE};
use polder_predicates::{Sign, orient2d};

/// For every vertex a half-edge that leaves it, or [`NONE`], and how many do. Any half-edge would do: nothing of a result
/// depends on which it is.
pub fn find_spokes(mesh: &GhostMesh, vertices: usize) -> (Vec<u32>, Vec<u32>) {
    let mut degrees = vec![0; vertices];
    for &v in mesh.triangles.iter().flatten() {
        if let Some(degree) = degrees.get_mut(v as usize) {
            *degree += 1;
        }
    }
    (mesh.half_edge_of_vertex(vertices), degrees)
}

/// For each point of the input the vertex that it is or equals.
pub fn name_points(order: &[u32], vertex_of: &[u32]) -> Vec<u32> {
    let mut vertices = vec![0; order.len()];
    order.iter().zip(vertex_of).for_each(|(&point, &v)| vertices[point as usize] = v);
    vertices
}

/// The ends of the constraints as vertices.
pub fn name_ends(vertices: &[u32], constraints: &[[u32; 2]]) -> Vec<[u32; 2]> {
    constraints.iter().map(|c| c.map(|end| vertices[end as usize])).collect()
}

/// What [`find_edges`] finds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edges {
    /// How many vertices the chain of each constraint has; [`NONE`] for one that has to walk.
    pub lengths: Vec<u32>,
    /// Whether it walks from its second end to its first.
    pub reversed: Vec<bool>,
    /// Those that have to walk, in order.
    pub walkers: Vec<u32>,
}

/// Which constraints are edges: one is looked for among up to `most` spokes of the end with fewer.
pub fn find_edges(mesh: &GhostMesh, ends: &[[u32; 2]], spokes: &[u32], degrees: &[u32], most: u32) -> Edges {
    let mut edges = Edges::default();
    for (c, &[a, b]) in ends.iter().enumerate() {
        let reversed = a != b && degrees[b as usize] < degrees[a as usize];
        let (from, to) = if reversed { (b, a) } else { (a, b) };
        let mut h = spokes[from as usize];
        let mut found = false;
        for _ in 0..degrees[from as usize].min(most) {
            found |= mesh.destination(h) == to;
            h = mesh.rotate_ccw(h);
        }
        let length = if a == b { 1 } else { 2 };
        edges.lengths.push(if a == b || found { length } else { NONE });
        edges.reversed.push(reversed);
        if a != b && !found {
            edges.walkers.push(c as u32);
        }
    }
    edges
}

/// Where a piece begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    /// It is about to cross this half-edge.
    Crossing(u32),
    /// At this vertex on the walker, which belongs to what the piece meets.
    AtVertex(u32),
}

impl Beginning {
    /// As the device has it.
    pub fn word(self) -> u32 {
        match self {
            Self::Crossing(h) => h,
            Self::AtVertex(v) => 1 << 31 | v,
        }
    }
}

/// A later piece of a long walk; those of one walker stand together in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Whose piece it is.
    pub walker: u32,
    /// Its number, from 1: the walk up to the first of these is number 0.
    pub number: u32,
    /// How many pieces the walker has, number 0 included.
    pub count: u32,
    /// Where it begins, if something was found.
    pub beginning: Option<Beginning>,
    /// In the first one of a walker: the least number of a piece that came to the walker's end.
    pub last: u32,
}

impl Piece {
    /// As the device has it.
    pub fn words(&self) -> [u32; 4] {
        [self.walker, self.number << 16 | self.count, self.beginning.map_or(NONE, Beginning::word), self.last]
    }

    /// Where the first later piece of the same walker stands, if this one stands at `p`.
    pub fn first(&self, p: usize) -> usize {
        p + 1 - self.number as usize
    }
}

/// The vertices that each item meets, from where it begins; `list` has the constraints that walk. A piece that comes to the
/// end of its constraint says so in the first one.
///
/// # Panics
///
/// If the mesh is not a triangulation of a convex hull.
pub fn walk_constraints(
    mesh: &GhostMesh,
    positions: &[DVec2],
    ends: &[[u32; 2]],
    spokes: &[u32],
    edges: &Edges,
    pieces: &mut [Piece],
) -> Vec<Vec<u32>> {
    let mut met = vec![Vec::new(); ends.len() + pieces.len()];
    let run_of = |c: u32, pieces: &[Piece]| pieces.iter().position(|piece| piece.walker == c);
    let later = (0..pieces.len()).map(|p| (pieces[p].walker, Some(p)));
    let items: Vec<(u32, Option<usize>)> = edges.walkers.iter().map(|&c| (c, None)).chain(later).collect();
    for (c, piece) in items {
        let [a, b] = ends[c as usize];
        let [from, to] = if edges.reversed[c as usize] { [b, a] } else { [a, b] };
        let run = run_of(c, pieces);
        let rest = match (piece, run) {
            (Some(p), Some(run)) => p + 1..run + pieces[run].count as usize - 1,
            (None, Some(run)) => run..run + pieces[run].count as usize - 1,
            _ => 0..0,
        };
        let until = pieces[rest].iter().find_map(|piece| piece.beginning);
        let item = piece.map_or(c as usize, |p| ends.len() + p);
        let start = match piece.map(|p| pieces[p].beginning) {
            None => depart_by_turning(mesh, positions, spokes[from as usize], to),
            Some(start) if start == until => continue,
            Some(Some(Beginning::AtVertex(v))) => {
                met[item].push(v);
                depart_by_turning(mesh, positions, spokes[v as usize], to)
            }
            Some(Some(Beginning::Crossing(h))) => Some(Departure::Across(h)),
            Some(None) => continue,
        };
        let at_end = walk_on(mesh, positions, [from, to], start, until, spokes, &mut met[item]);
        if let (true, Some(run)) = (at_end, run) {
            pieces[run].last = pieces[run].last.min(piece.map_or(0, |p| pieces[p].number));
        }
    }
    met
}

/// Whether the walk came to its end, not to `until`.
fn walk_on(
    mesh: &GhostMesh,
    positions: &[DVec2],
    [from, to]: [u32; 2],
    start: Option<Departure>,
    until: Option<Beginning>,
    spokes: &[u32],
    met: &mut Vec<u32>,
) -> bool {
    let line = [from, to].map(|v| positions[v as usize]);
    let mut departure = start;
    loop {
        let vertex = match departure.expect("the mesh is a triangulation of a convex hull") {
            Departure::Along(h) => mesh.destination(h),
            Departure::Across(mut h) => loop {
                if until == Some(Beginning::Crossing(h)) {
                    return false;
                }
                let (g, side) = enter(mesh, positions, h, line).expect("the mesh is a triangulation of a convex hull");
                if side == Sign::Zero {
                    break mesh.apex(g);
                }
                h = leave(g, side);
            },
        };
        if vertex == to || until == Some(Beginning::AtVertex(vertex)) {
            return vertex == to;
        }
        met.push(vertex);
        departure = depart_by_turning(mesh, positions, spokes[vertex as usize], to);
    }
}

/// What superfluous pieces met is forgotten; what the others met is added to the length of the chain.
pub fn trim_pieces(pieces: &[Piece], piece_met: &mut [u32], lengths: &mut [u32]) {
    for (p, piece) in pieces.iter().enumerate() {
        if piece.number > pieces[piece.first(p)].last {
            piece_met[p] = 0;
        } else {
            lengths[piece.walker as usize] += piece_met[p];
        }
    }
}

/// The chain of each constraint from its ends and what its items met, which [`trim_pieces`] has counted.
pub fn place_chains(
    ends: &[[u32; 2]],
    reversed: &[bool],
    pieces: &[Piece],
    piece_met: &[u32],
    met: &[Vec<u32>],
) -> Vec<Vec<u32>> {
    let mut chains = met[..ends.len()].to_vec();
    for (p, piece) in pieces.iter().enumerate().filter(|(p, _)| piece_met[*p] > 0) {
        chains[piece.walker as usize].extend(&met[ends.len() + p]);
    }
    for ((chain, &[a, b]), &reversed) in chains.iter_mut().zip(ends).zip(reversed) {
        if reversed {
            chain.reverse();
        }
        chain.insert(0, a);
        if a != b {
            chain.push(b);
        }
    }
    chains
}

/// The sub-constraints along chains, the lower vertex of each first.
pub fn list_sub_constraints(chains: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let pairs = chains.iter().flat_map(|chain| chain.windows(2));
    pairs.map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]).collect()
}

/// From one round of walks to the next; before the first, to `walkers` constraints and all later pieces.
///
/// Words: items that go on; at 24 items of the next round; from 2 on which list, the round, three of workgroups, and the
/// constraints of the first list.
pub fn walk_turn(words: &mut [u32], pieces: u32, begins: bool) {
    let waiting = if begins { words[24] + pieces } else { words[24] };
    if begins {
        words[7] = words[24];
    }
    let (parity, round) = (words[2], words[3]);
    words[0] = waiting;
    words[24] = 0;
    words[2] = if begins { 0 } else { 1 - parity };
    words[3] = if begins { 0 } else { round + 1 };
    words[4..7].copy_from_slice(&polder_vulkan::groups_for(waiting as usize, 256));
}

/// Up to two vertices of each cell of a grid, one with an even priority and one with an odd one, or [`NONE`]. Any would do.
pub fn sow_seeds(positions: &[DVec2], spokes: &[u32], grid: &Grid) -> Vec<[u32; 2]> {
    let [width, height] = grid.size();
    let mut seeds = vec![[NONE; 2]; width as usize * height as usize];
    for (v, &p) in positions.iter().enumerate().filter(|(v, _)| spokes[*v] != NONE) {
        seeds[grid.cell(p)][priority(v as u32) as usize & 1] = v as u32;
    }
    seeds
}

/// How many pieces all listed walkers together should have after their first ones.
pub fn count_pieces(positions: &[DVec2], ends: &[[u32; 2]], list: &[u32], grid: &Grid) -> u64 {
    list.iter().map(|&walker| u64::from(grid.pieces(ends[walker as usize].map(|v| positions[v as usize])) - 1)).sum()
}

/// How many pieces each listed walker has, with so much room for later ones.
pub fn plan_pieces(positions: &[DVec2], ends: &[[u32; 2]], list: &[u32], grid: &Grid, room: usize) -> Vec<u32> {
    let share = (count_pieces(positions, ends, list, grid) / room.max(1) as u64).min(4096) as u32 + 1;
    let wanted = |&walker: &u32| grid.pieces(ends[walker as usize].map(|v| positions[v as usize]));
    list.iter().map(|walker| (wanted(walker) / share).max(1)).collect()
}

/// What a walk from one vertex to another comes over: half-edges by which it leaves triangles, and vertices.
fn crossed_between(mesh: &GhostMesh, positions: &[DVec2], spokes: &[u32], [from, to]: [u32; 2]) -> Vec<Beginning> {
    let line = [from, to].map(|v| positions[v as usize]);
    let mut crossed = Vec::new();
    let mut v = from;
    while v != to {
        v = match depart_by_turning(mesh, positions, spokes[v as usize], to) {
            None => return crossed,
            Some(Departure::Along(h)) => {
                crossed.push(Beginning::Crossing(h));
                mesh.destination(h)
            }
            Some(Departure::Across(mut h)) => loop {
                crossed.push(Beginning::Crossing(h));
                let Some((g, side)) = enter(mesh, positions, h, line) else { return crossed };
                if side == Sign::Zero {
                    crossed.push(Beginning::AtVertex(mesh.apex(g)));
                    break mesh.apex(g);
                }
                h = leave(g, side);
            },
        };
    }
    crossed
}

/// Where the line between two vertices is, near some others: the first edge that it crosses, by the half-edge that begins to
/// the right, or vertex that it runs through, on the way from a vertex to the left to one to the right. Of the candidates, the
/// first of either kind are tried, then the first among the rest, and so on. `near` says what serves.
pub fn find_beginnings(
    mesh: &GhostMesh,
    positions: &[DVec2],
    spokes: &[u32],
    line: [u32; 2],
    candidates: &[u32],
    near: impl Fn([DVec2; 2]) -> bool,
) -> Option<Beginning> {
    let at = |v: u32| positions[v as usize];
    let [a, b] = line.map(at);
    let side = |v: u32| orient2d(a, b, at(v));
    let inside = |v: u32| !line.contains(&v) && ahead(a, at(v), b) && ahead(b, at(v), a);
    let between = |v: u32| side(v) == Sign::Zero && inside(v) && near([at(v); 2]);
    let apart = |p: Sign, q: Sign| p != Sign::Zero && p as i8 == -(q as i8);
    let [mut left, mut right] = [None; 2];
    for &v in candidates {
        if between(v) {
            return Some(Beginning::AtVertex(v));
        }
        match side(v) {
            Sign::Positive => left = left.or(Some(v)),
            Sign::Negative => right = right.or(Some(v)),
            Sign::Zero => {}
        }
        let (Some(first), Some(second)) = (left, right) else { continue };
        [left, right] = [None; 2];
        for found in crossed_between(mesh, positions, spokes, [first, second]) {
            let on_way = match found {
                Beginning::Crossing(h) => [mesh.origin(h), mesh.destination(h)],
                Beginning::AtVertex(v) => [v, v],
            };
            // The second is looked at only if the first lies to one side.
            let [u, v] = on_way;
            if let Some(v) = [u, v].into_iter().take_while(|&w| w == u || side(u) != Sign::Zero).find(|&v| between(v)) {
                return Some(Beginning::AtVertex(v));
            }
            let across = |p: DVec2| orient2d(at(u), at(v), p);
            let crossed = apart(side(u), side(v)) && apart(across(a), across(b)) && near([at(u), at(v)]);
            if let (Beginning::Crossing(h), true) = (found, crossed) {
                return Some(Beginning::Crossing(if side(u) == Sign::Negative { h } else { mesh.twin(h) }));
            }
        }
    }
    None
}

/// Constraints of walks that go on, and how many buckets each has with so much room for pieces; none if that is not worth it.
pub fn plan_again(waiting: &[u32], room: usize) -> (Vec<u32>, u32) {
    let mut chosen = waiting.to_vec();
    chosen.sort_unstable();
    chosen.dedup();
    let count = chosen.len().min(32);
    let buckets = (room.saturating_sub(count) / count.max(1)).min(16_384) as u32;
    if buckets < 128 { (Vec::new(), 0) } else { (chosen, buckets) }
}

/// By bucket along a line the least of the vertices there, or [`NONE`].
pub fn spread_vertices(positions: &[DVec2], spokes: &[u32], line: [u32; 2], grid: &Grid, buckets: u32) -> Vec<u32> {
    let [a, b] = line.map(|v| positions[v as usize]);
    let mut least = vec![NONE; buckets as usize];
    for (v, &p) in positions.iter().enumerate().filter(|&(v, _)| spokes[v] != NONE) {
        let between = p != a && p != b && ahead(a, p, b) && ahead(b, p, a);
        if between && orient2d(a, b, p) == Sign::Zero {
            let bucket = &mut least[grid.bucket([a, b], p, buckets)];
            *bucket = (*bucket).min(v as u32);
        }
    }
    least
}

/// The numbers of a constraint's new pieces, from 1, and the vertices at which they begin; none if it has too few for the pieces
/// that it had.
pub fn begin_again(buckets: &[u32], pieces: u32) -> Option<Vec<(u32, u32)>> {
    let found = (1..).zip(buckets.iter().copied()).filter(|&(_, v)| v != NONE).collect::<Vec<_>>();
    (found.len() >= 64 + 2 * pieces as usize).then_some(found)
}
