//! Constraints that cross are cut where they do.
//!
//! In rounds over the current edges, at first the constraints:
//!
//! 1. All points are triangulated, and all edges walk that triangulation: each is cut at the vertices exactly on it, and
//!    all pairs that cross properly come out.
//! 2. Each crossing gets a point, the intersection of its two edges, each coordinate correctly rounded. Equal points are
//!    one, also with vertices that are there already. New ones are numbered by x, then y, behind all others.
//! 3. Each edge is cut at its points, in order along it. Rounding keeps order, so the order is that of coordinates.
//! 4. A rounded point lies a little beside its edges, so the pieces may cross other edges: the next round sees.
//!
//! Until nothing crosses. No proof is known that this ends; what is nearly parallel or meets nearly in one point takes a
//! few rounds. So rounds are bounded, as are vertices and crossings. An edge is cut by every crossing: its point is no
//! vertex of both edges, since edges with a vertex in common do not cross properly.
//!
//! The points depend on the set of edges alone, not on the order or the direction of the constraints, nor on the
//! backend, which gets points and edges that do not cross.

use crate::report::{Place, Stopwatch};
use crate::{AddedVertex, ConstraintId, CrossingPolicy, DVec2, Error, Options, Output, Pslg, Triangulation};
use polder_constrain::reference::{crossings, intersection, walk};
use polder_cpu::Delaunay;
use polder_mesh::Chains;
use rayon::prelude::*;
use std::collections::HashMap;

/// How often edges are cut.
const ROUNDS: u32 = 64;
/// Crossings of one round.
const MOST_CROSSINGS: usize = 1 << 26;

/// Points and edges that do not cross, and how they came about.
struct Split {
    /// The input's points, then the added vertices; the edges, sorted, each once.
    pslg: Pslg,
    added: Vec<AddedVertex>,
    /// For each constraint of the input the vertices along it.
    chains: Chains,
    rounds: u32,
}

/// Triangulates with a backend to which constraints that cross are an error; where the policy says so, they are cut first.
/// `place` is where the backend works, and meets the first crossing.
pub(crate) fn by_policy(
    input: &Pslg,
    options: &Options,
    place: Place,
    mut backend: impl FnMut(&Pslg, &Options) -> Result<Output, Error>,
) -> Result<Output, Error> {
    if options.crossings == CrossingPolicy::Error {
        return backend(input, options);
    }
    let refusing = Options { crossings: CrossingPolicy::Error, max_crossings: 0, ..options.clone() };
    let mut watch = Stopwatch::start();
    match backend(input, &refusing) {
        Err(Error::CrossingConstraints { .. }) => {}
        other => return other,
    }
    watch.stage_on(place, "crossings_met", []);
    let split = split(input, options)?;
    let (rounds, added) = (u64::from(split.rounds), split.added.len() as u64);
    watch.stage("split", [("rounds", rounds), ("added_vertices", added)]);
    let Output { triangulation, report } = backend(&split.pslg, &refusing)?;
    let triangulation = split.restored(triangulation)?;
    let report = report.of_split(input, &triangulation, watch);
    Ok(Output { triangulation, report })
}

/// A point as what is equal by value: -0.0 is 0.0.
fn key(p: DVec2) -> [u64; 2] {
    [p.x + 0.0, p.y + 0.0].map(f64::to_bits)
}

/// The edges of chains, from the lower vertex to the higher, sorted, each once.
fn edges_of(chains: &Chains) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> =
        chains.iter().flat_map(|chain| chain.windows(2)).map(|w| [w[0].min(w[1]), w[0].max(w[1])]).collect();
    edges.par_sort_unstable();
    edges.dedup();
    edges
}

/// Chains in which each edge has become a row of vertices: `between` says those between the ends of an edge, from its
/// lower vertex to its higher one.
fn refined(chains: &Chains, edges: &[[u32; 2]], between: impl Fn(usize) -> Vec<u32>) -> Result<Chains, Error> {
    let mut out = Chains::with_capacity(chains.len());
    let mut room = Chains::MAX_VERTICES;
    for chain in chains.iter() {
        let mut row: Vec<u32> = chain.first().copied().into_iter().collect();
        for w in chain.windows(2) {
            let inner = edges.binary_search(&[w[0].min(w[1]), w[0].max(w[1])]).map(&between).unwrap_or_default();
            if w[0] < w[1] {
                row.extend(inner)
            } else {
                row.extend(inner.into_iter().rev())
            }
            row.push(w[1]);
        }
        room = room.checked_sub(row.len()).ok_or_else(crate::error::too_many_chain_vertices)?;
        out.push(row);
    }
    Ok(out)
}

/// Cuts all constraints where they cross.
fn split(input: &Pslg, options: &Options) -> Result<Split, Error> {
    let mut points = input.points().to_vec();
    let mut added: Vec<AddedVertex> = Vec::new();
    let typed = |error: polder_cpu::CpuError| crate::cpu::typed(error);
    let mut chains = Chains::with_capacity(input.constraints().len());
    for round in 1..=ROUNDS {
        // Step 1.
        let monitor = options.monitor();
        monitor.step("split", u64::from(round), u64::from(ROUNDS))?;
        let delaunay = Delaunay::new(&points, monitor).map_err(typed)?;
        if round == 1 {
            let of = delaunay.representatives();
            for &ends in input.constraints() {
                let [a, b] = ends.map(|v| of[v as usize]);
                chains.push([a].into_iter().chain((a != b).then_some(b)));
            }
        }
        let edges = edges_of(&chains);
        let ends = delaunay.vertices_of(&edges).map_err(typed)?;
        let (mesh, positions, ids) = delaunay.to_ghost_mesh();
        drop(delaunay);
        let walk = walk(&mesh, &positions, &ends)?;
        let found = crossings(&mesh, &positions, &walk, MOST_CROSSINGS)?;
        drop(mesh);
        if found.truncated {
            return Err(Error::SplitTooLarge { what: "crossings in one round", limit: MOST_CROSSINGS });
        }
        let inner: Vec<Vec<u32>> = walk
            .chains
            .iter()
            .map(|chain| chain[1..chain.len() - 1].iter().map(|&v| ids[v as usize]).collect())
            .collect();
        if found.pairs.is_empty() {
            let chains = refined(&chains, &edges, |e| inner[e].clone())?;
            name_parents(&mut added, &chains, input.points().len());
            let pslg = Pslg::new(points, edges_of(&chains))?;
            return Ok(Split { pslg, added, chains, rounds: round - 1 });
        }

        // Step 2.
        let line = |points: &[DVec2], e: u32| edges[e as usize].map(|v| points[v as usize]);
        let crossing = |&[e, f]: &[u32; 2]| intersection(line(&points, e), line(&points, f));
        let places: Vec<Option<DVec2>> = found.pairs.par_iter().map(crossing).collect();
        let mut names: HashMap<[u64; 2], u32> = HashMap::with_capacity(places.len());
        let mut new: Vec<DVec2> = Vec::new();
        for &place in places.iter().flatten() {
            names.entry(key(place)).or_insert_with(|| {
                new.push(place);
                u32::MAX
            });
        }
        for (i, &p) in points.iter().enumerate() {
            if let Some(name) = names.get_mut(&key(p)).filter(|name| **name == u32::MAX) {
                *name = i as u32;
            }
        }
        new.retain(|&p| names[&key(p)] == u32::MAX);
        new.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        if added.len() + new.len() > options.max_added_vertices {
            return Err(Error::SplitTooLarge { what: "added vertices", limit: options.max_added_vertices });
        }
        for &position in &new {
            names.insert(key(position), points.len() as u32);
            points.push(position);
            added.push(AddedVertex { position, round, parents: Vec::new() });
        }
        let mut cuts: Vec<(u32, u32)> = Vec::with_capacity(2 * found.pairs.len());
        for (&[e, f], place) in found.pairs.iter().zip(&places) {
            let Some(place) = place else { continue };
            let name = names[&key(*place)];
            cuts.extend([(e, name), (f, name)]);
        }

        // Step 3.
        for (e, inner) in inner.into_iter().enumerate() {
            cuts.extend(inner.into_iter().map(|v| (e as u32, v)));
        }
        cuts.par_sort_unstable_by(|&(e, v), &(f, w)| {
            e.cmp(&f).then_with(|| {
                let [a, b] = line(&points, e);
                let (p, q) = (points[v as usize], points[w as usize]);
                let along = |a: f64, b: f64, p: f64, q: f64| if a <= b { p.total_cmp(&q) } else { q.total_cmp(&p) };
                let (p, q) = (p + 0.0, q + 0.0);
                along(a.x, b.x, p.x, q.x).then_with(|| along(a.y, b.y, p.y, q.y)).then(v.cmp(&w))
            })
        });
        cuts.dedup();
        let mut starts: Vec<usize> = vec![0; edges.len() + 1];
        cuts.iter().for_each(|&(e, _)| starts[e as usize + 1] += 1);
        (0..edges.len()).for_each(|e| starts[e + 1] += starts[e]);
        let between = |e: usize| {
            let row = cuts[starts[e]..starts[e + 1]].iter().map(|&(_, v)| v);
            row.filter(|v| !edges[e].contains(v)).collect::<Vec<_>>()
        };
        chains = refined(&chains, &edges, between)?;
    }
    Err(Error::SplitUnfinished { rounds: ROUNDS })
}

/// Says of each added vertex which constraints run through it.
fn name_parents(added: &mut [AddedVertex], chains: &Chains, first: usize) {
    for (i, chain) in chains.iter().enumerate() {
        for &v in chain {
            if let Some(vertex) = (v as usize).checked_sub(first).and_then(|v| added.get_mut(v)) {
                vertex.parents.push(ConstraintId(i as u32));
            }
        }
    }
}

impl Split {
    /// The triangulation of the cut constraints, as one of the input.
    fn restored(self, triangulation: Triangulation) -> Result<Triangulation, Error> {
        let edges = self.pslg.constraints();
        let between = |e: usize| {
            let chain = triangulation.chains().get(e);
            chain.get(1..chain.len().saturating_sub(1)).unwrap_or_default().to_vec()
        };
        let chains = refined(&self.chains, edges, between)?;
        Ok(triangulation.with_added(self.added, chains))
    }
}
