//! Constraints that cross are cut where they do.
//!
//! In rounds over the current edges, at first the constraints:
//!
//! 1. All points are triangulated, and all edges walk that triangulation: each is cut at the vertices exactly on it, and
//!    all pairs that cross properly come out.
//! 2. If some do after the first round, pieces were bent across each other by rounding. Then each edge is also cut at those
//!    vertices of the round before that it passes at less than rounding can tell, as if it had crossed what others crossed
//!    there; and what crosses is found anew.
//! 3. Each crossing gets a point, the intersection of its two edges, each coordinate correctly rounded. Equal points are
//!    one, also with vertices that are there already. New ones are numbered by x, then y, behind all others.
//! 4. Each edge is cut at its points, in order along it. Rounding keeps order, so the order is that of coordinates.
//!
//! Until nothing crosses. A rounded point lies a little beside its edges, so pieces may cross other edges, which the next
//! round sees. In bundles of lines that are nowhere farther apart than a few last places, that alone never comes to an end,
//! or after millions of vertices; step 2 brings the lines together where they cannot be told apart, and of 99 bundles of up
//! to 200 lines none took more than seven rounds. No proof is known that this ends; so rounds are bounded, as are
//! vertices and crossings. An edge is cut by every crossing: its point is no vertex of both edges, since edges with a vertex
//! in common do not cross properly.
//!
//! The points depend on the set of edges alone, not on the order or the direction of the constraints, nor on the
//! backend, which gets points and edges that do not cross.

use crate::cpu::{in_pool, typed};
use crate::report::{Place, Stopwatch};
use crate::{AddedVertex, ConstraintId, CrossingPolicy, DVec2, Error, Options, Output, Pslg};
use polder_constrain::Walk;
use polder_constrain::reference::{crossings, intersection, near, walk};
use polder_cpu::Delaunay;
use polder_mesh::{Chains, GhostMesh, NONE};
use rayon::prelude::*;
use std::collections::HashMap;

/// How often edges are cut.
const ROUNDS: u32 = 64;
/// Crossings of one round.
const MOST_CROSSINGS: usize = 1 << 26;

/// Points and edges that do not cross, and how they came about.
pub(crate) struct Split {
    /// The input's points, then the added vertices; the edges, sorted, each once, none through a vertex.
    pub(crate) pslg: Pslg,
    pub(crate) added: Vec<AddedVertex>,
    /// For each constraint of the input the vertices along it.
    pub(crate) chains: Chains,
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
    watch.stage("split", split.counts());
    let Output { triangulation, report } = backend(&split.pslg, &refusing).map_err(pieces_cross)?;
    let triangulation = triangulation.with_added(split.added, split.chains);
    let report = report.of_split(input, &triangulation, watch);
    Ok(Output { triangulation, report })
}

/// Pieces that cross are a defect, and no crossing of the input's.
pub(crate) fn pieces_cross(error: Error) -> Error {
    match error {
        Error::CrossingConstraints { .. } => {
            Error::Internal { stage: "split", what: "constraints were cut, but their pieces cross".to_owned() }
        }
        other => other,
    }
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

/// The Delaunay triangulation of some points.
struct Mesh {
    mesh: GhostMesh,
    positions: Vec<DVec2>,
    /// The point of each vertex, and the vertex of each point that is one.
    ids: Vec<u32>,
    vertices: Vec<u32>,
}

impl Mesh {
    fn walk(&self, edges: &[[u32; 2]]) -> Result<Walk, Error> {
        let ends: Vec<[u32; 2]> = edges.iter().map(|edge| edge.map(|v| self.vertices[v as usize])).collect();
        Ok(walk(&self.mesh, &self.positions, &ends)?)
    }

    /// The vertices exactly on edges, between their ends.
    fn on(&self, walk: &Walk) -> Vec<Cut> {
        let chains = walk.chains.iter().enumerate();
        let inner = chains.flat_map(|(e, chain)| chain.iter().skip(1).rev().skip(1).map(move |&v| (e as u32, v)));
        inner.map(|(e, v)| (e, self.ids[v as usize])).collect()
    }

    /// The vertices, from point `first` on, that edges pass at less than rounding can tell.
    fn near(&self, walk: &Walk, first: u32) -> Result<Vec<Cut>, Error> {
        let wanted = |v: u32| self.ids[v as usize] >= first;
        let of_edge = |e: usize| {
            let near = near(&self.mesh, &self.positions, walk, e, wanted)?;
            Ok(near.into_iter().map(|v| (e as u32, self.ids[v as usize])).collect())
        };
        let near: Result<Vec<Vec<Cut>>, Error> = (0..walk.chains.len()).into_par_iter().map(of_edge).collect();
        Ok(near?.concat())
    }

    /// The pairs of edges that cross properly.
    fn crossings(&self, walk: &Walk) -> Result<Vec<[u32; 2]>, Error> {
        let found = crossings(&self.mesh, &self.positions, walk, MOST_CROSSINGS)?;
        if found.truncated {
            return Err(Error::SplitTooLarge { what: "crossings in one round", limit: MOST_CROSSINGS });
        }
        Ok(found.pairs)
    }
}

/// An edge, and a vertex at which it is cut.
type Cut = (u32, u32);

/// What has been made of the input so far.
struct Cutting<'a> {
    options: &'a Options,
    /// The input's points, then the added ones.
    points: Vec<DVec2>,
    added: Vec<AddedVertex>,
    chains: Chains,
}

impl<'a> Cutting<'a> {
    fn new(input: &Pslg, options: &'a Options) -> Self {
        let chains = Chains::with_capacity(input.constraints().len());
        Self { options, points: input.points().to_vec(), added: Vec::new(), chains }
    }

    fn mesh(&mut self, input: &Pslg) -> Result<Mesh, Error> {
        let delaunay = Delaunay::new(&self.points, self.options.monitor()).map_err(typed)?;
        if self.chains.len() < input.constraints().len() {
            let of = delaunay.representatives();
            for &ends in input.constraints() {
                let [a, b] = ends.map(|v| of[v as usize]);
                self.chains.push([a].into_iter().chain((a != b).then_some(b)));
            }
        }
        let (mesh, positions, ids) = delaunay.to_ghost_mesh();
        let mut vertices = vec![NONE; self.points.len()];
        ids.iter().enumerate().for_each(|(v, &id)| vertices[id as usize] = v as u32);
        Ok(Mesh { mesh, positions, ids, vertices })
    }

    /// Adds the points where edges cross, those that are no points yet; returns the point of each crossing.
    fn add(&mut self, round: u32, edges: &[[u32; 2]], pairs: &[[u32; 2]]) -> Result<Vec<u32>, Error> {
        let line = |e: u32| edges[e as usize].map(|v| self.points[v as usize]);
        let places: Vec<Option<DVec2>> = pairs.par_iter().map(|&[e, f]| intersection(line(e), line(f))).collect();
        let mut names: HashMap<[u64; 2], u32> = HashMap::with_capacity(places.len());
        let mut new: Vec<DVec2> = Vec::new();
        for &place in places.iter().flatten() {
            names.entry(key(place)).or_insert_with(|| {
                new.push(place);
                NONE
            });
        }
        for (i, &p) in self.points.iter().enumerate() {
            if let Some(name) = names.get_mut(&key(p)).filter(|name| **name == NONE) {
                *name = i as u32;
            }
        }
        new.retain(|&p| names[&key(p)] == NONE);
        new.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        let limit = self.options.max_added_vertices;
        if self.added.len() + new.len() > limit {
            return Err(Error::SplitTooLarge { what: "added vertices", limit });
        }
        for &position in &new {
            names.insert(key(position), self.points.len() as u32);
            self.points.push(position);
            self.added.push(AddedVertex { position, round, parents: Vec::new() });
        }
        Ok(places.iter().map(|place| place.map_or(NONE, |place| names[&key(place)])).collect())
    }

    /// Cuts edges: in each chain a row of vertices takes the place of each edge that is cut.
    fn cut(&mut self, edges: &[[u32; 2]], mut cuts: Vec<Cut>) -> Result<(), Error> {
        let at = |v: u32| self.points[v as usize] + DVec2::ZERO;
        cuts.retain(|&(e, v)| v != NONE && !edges[e as usize].contains(&v));
        cuts.par_sort_unstable_by(|&(e, v), &(f, w)| {
            e.cmp(&f).then_with(|| {
                let [a, b] = edges[e as usize].map(at);
                let (p, q) = (at(v), at(w));
                let along = |a: f64, b: f64, p: f64, q: f64| if a <= b { p.total_cmp(&q) } else { q.total_cmp(&p) };
                along(a.x, b.x, p.x, q.x).then_with(|| along(a.y, b.y, p.y, q.y)).then(v.cmp(&w))
            })
        });
        cuts.dedup();
        let mut starts: Vec<usize> = vec![0; edges.len() + 1];
        cuts.iter().for_each(|&(e, _)| starts[e as usize + 1] += 1);
        (0..edges.len()).for_each(|e| starts[e + 1] += starts[e]);

        let mut refined = Chains::with_capacity(self.chains.len());
        let mut room = Chains::MAX_VERTICES;
        for chain in self.chains.iter() {
            let mut row: Vec<u32> = chain.first().copied().into_iter().collect();
            for w in chain.windows(2) {
                let found = edges.binary_search(&[w[0].min(w[1]), w[0].max(w[1])]);
                let cuts = found.map_or(&[][..], |e| &cuts[starts[e]..starts[e + 1]]);
                let between = cuts.iter().map(|&(_, v)| v);
                if w[0] < w[1] {
                    row.extend(between)
                } else {
                    row.extend(between.rev())
                }
                row.push(w[1]);
            }
            room = room.checked_sub(row.len()).ok_or_else(crate::error::too_many_chain_vertices)?;
            refined.push(row);
        }
        self.chains = refined;
        Ok(())
    }

    /// Nothing crosses any more; the first points are the input's.
    fn done(mut self, first: usize, rounds: u32) -> Result<Split, Error> {
        // Of each added vertex, which constraints run through it.
        for (i, chain) in self.chains.iter().enumerate() {
            for &v in chain {
                if let Some(vertex) = (v as usize).checked_sub(first).and_then(|v| self.added.get_mut(v)) {
                    vertex.parents.push(ConstraintId(i as u32));
                }
            }
        }
        let pslg = Pslg::new(self.points, edges_of(&self.chains))?;
        Ok(Split { pslg, added: self.added, chains: self.chains, rounds })
    }
}

/// Cuts all constraints where they cross.
pub(crate) fn split(input: &Pslg, options: &Options) -> Result<Split, Error> {
    in_pool(options, || split_here(input, options))
}

fn split_here(input: &Pslg, options: &Options) -> Result<Split, Error> {
    let mut cutting = Cutting::new(input, options);
    // The points of the rounds before the last one.
    let mut old = 0;
    for round in 1..=ROUNDS {
        // Step 1.
        options.monitor().step("split", u64::from(round), u64::from(ROUNDS))?;
        let mesh = cutting.mesh(input)?;
        let mut edges = edges_of(&cutting.chains);
        let mut walk = mesh.walk(&edges)?;
        let mut pairs = mesh.crossings(&walk)?;
        // Step 2.
        if round > 1 && !pairs.is_empty() {
            let near = mesh.near(&walk, old)?;
            if !near.is_empty() {
                cutting.cut(&edges, [mesh.on(&walk), near].concat())?;
                edges = edges_of(&cutting.chains);
                walk = mesh.walk(&edges)?;
                pairs = mesh.crossings(&walk)?;
            }
        }
        let mut cuts = mesh.on(&walk);
        if pairs.is_empty() {
            cutting.cut(&edges, cuts)?;
            return cutting.done(input.points().len(), round - 1);
        }
        // Step 3.
        old = cutting.points.len() as u32;
        let names = cutting.add(round, &edges, &pairs)?;
        cuts.extend(pairs.iter().zip(names).flat_map(|(&[e, f], name)| [(e, name), (f, name)]));
        // Step 4.
        cutting.cut(&edges, cuts)?;
    }
    Err(Error::SplitUnfinished { rounds: ROUNDS })
}

impl Split {
    /// What the report says of it.
    pub(crate) fn counts(&self) -> [(&'static str, u64); 2] {
        [("rounds", self.rounds.into()), ("added_vertices", self.added.len() as u64)]
    }
}
