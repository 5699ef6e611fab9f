//! Constraints, one by one.
//!
//! Each constraint walks from one of its ends; where it meets a vertex it is cut. Edges on its way are marked; the
//! triangles that a piece crosses are replaced by [`Cavity`]. After each piece the mesh is the canonical constrained
//! Delaunay triangulation of what is in it, so that the order of the constraints does not matter to the result: they
//! go in the order of the points, for locality.

use crate::cavity::Cavity;
use crate::mesh::{NONE, Slab};
use crate::order::radix_sort;
use crate::walk::{End, First, Strip, along, first};
use crate::{CpuError, Delaunay};
use polder_mesh::{Chains, Constraint, DELETED, Monitor};

/// How often the monitor is asked.
const STEP: usize = 1 << 10;

/// What inserting constraints counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConstrainCounts {
    /// Edges that are part of a constraint.
    pub constrained_edges: u64,
    /// Triangles that were taken out because a constraint crossed them.
    pub crossed_triangles: u64,
    /// Flips that restored the constrained Delaunay property.
    pub flips: u64,
    /// Constraints that pass through vertices between their ends.
    pub through_vertices: u64,
}

/// The state of the insertion.
struct Inserter<'a> {
    delaunay: &'a mut Delaunay,
    /// For each vertex a half-edge that starts there.
    half_edges: Vec<u32>,
    strip: Strip,
    cavity: Cavity,
    counts: ConstrainCounts,
}

impl Delaunay {
    /// Inserts constraints, given by input points. Returns the vertices along each, as input points.
    ///
    /// # Errors
    ///
    /// [`CpuError::Crossing`] at the first constraint that properly crosses one inserted before; the triangulation then
    /// holds those inserted so far. [`CpuError::IndexOutOfRange`] before anything is changed. [`CpuError::TooLarge`] where the chains together
    /// would have more than [`Chains::MAX_VERTICES`] vertices. [`CpuError::Cancelled`].
    pub fn constrain(
        &mut self,
        constraints: &[Constraint],
        monitor: Monitor<'_>,
    ) -> Result<(Chains, ConstrainCounts), CpuError> {
        let vertices = self.vertices_of(constraints)?;
        let mut degree = vec![0u32; if constraints.is_empty() { 0 } else { self.vertices() }];
        let mut queue: Vec<u64> = Vec::with_capacity(constraints.len());
        for (i, &[a, b]) in vertices.iter().enumerate() {
            degree[a as usize] += 1;
            degree[b as usize] += 1;
            queue.push(u64::from(a.min(b)) << 32 | i as u64);
        }
        radix_sort(&mut queue);

        let mut inserter = Inserter::new(self, !constraints.is_empty());
        let mut long = Vec::new();
        let mut room = Chains::MAX_VERTICES.saturating_sub(2 * constraints.len());
        for (done, item) in queue.iter().enumerate() {
            if done % STEP == 0 {
                monitor.step("constrain", done as u64, queue.len() as u64)?;
            }
            let i = *item as u32;
            let [a, b] = vertices[i as usize];
            // Start at the end with fewer constraints: looking round a hub for each of its spokes would be quadratic.
            let turned = degree[a as usize] > degree[b as usize];
            let (from, to) = if turned { (b, a) } else { (a, b) };
            let mut between = inserter.insert(i, from, to)?;
            if !between.is_empty() {
                room = room.checked_sub(between.len()).ok_or(CpuError::TooLarge { constraint: i })?;
                if turned {
                    between.reverse();
                }
                long.push((i, between));
            }
        }
        let counts = inserter.counts;
        Ok((self.chains(&vertices, long), counts))
    }

    /// The constraints' ends as vertices of [`to_ghost_mesh`](Self::to_ghost_mesh).
    ///
    /// # Errors
    ///
    /// [`CpuError::IndexOutOfRange`] at the first constraint that names a point that does not exist.
    pub fn vertices_of(&self, constraints: &[Constraint]) -> Result<Vec<[u32; 2]>, CpuError> {
        if constraints.is_empty() {
            return Ok(Vec::new());
        }
        let mut place = vec![NONE; self.order.representatives.len()];
        for (v, &id) in self.order.ids.iter().enumerate() {
            place[id as usize] = v as u32;
        }
        let vertex = |i: usize, index: u32| match self.order.representatives.get(index as usize) {
            Some(&id) => Ok(place[id as usize]),
            None => Err(CpuError::IndexOutOfRange { constraint: i as u32, index }),
        };
        constraints.iter().enumerate().map(|(i, &[a, b])| Ok([vertex(i, a)?, vertex(i, b)?])).collect()
    }

    fn chains(&self, vertices: &[[u32; 2]], mut long: Vec<(u32, Vec<u32>)>) -> Chains {
        long.sort_unstable_by_key(|(i, _)| *i);
        let mut long = long.into_iter().peekable();
        let mut chains = Chains::with_capacity(vertices.len());
        let id = |v: u32| self.order.ids[v as usize];
        for (i, &[a, b]) in vertices.iter().enumerate() {
            let between = long.next_if(|(j, _)| *j as usize == i).map(|(_, between)| between).unwrap_or_default();
            let end = (a != b).then_some(b);
            chains.push([a].into_iter().chain(between).chain(end).map(id));
        }
        chains
    }
}

impl<'a> Inserter<'a> {
    fn new(delaunay: &'a mut Delaunay, needed: bool) -> Self {
        let mut half_edges = vec![NONE; if needed { delaunay.vertices() } else { 0 }];
        if needed {
            for (t, tri) in delaunay.tris.iter().enumerate() {
                for k in 0..3 {
                    let v = tri.v[(k + 1) % 3];
                    if v < DELETED {
                        half_edges[v as usize] = (4 * t + k) as u32;
                    }
                }
            }
        }
        Self {
            delaunay,
            half_edges,
            strip: Strip::default(),
            cavity: Cavity::default(),
            counts: ConstrainCounts::default(),
        }
    }

    /// Inserts one constraint; returns the vertices that it passes through between its ends.
    fn insert(&mut self, constraint: u32, from: u32, to: u32) -> Result<Vec<u32>, CpuError> {
        let points = &self.delaunay.order.points;
        let mut slab = Slab { tris: &mut self.delaunay.tris, base: 0 };
        let lost = |what| CpuError::BoundExceeded { constraint, what };
        let mut between = Vec::new();
        let mut at = from;
        while at != to {
            let next = match first(points, &slab, self.half_edges[at as usize], at, to) {
                First::Nothing => return Err(lost("look around a vertex")),
                First::Edge(h) => {
                    self.counts.constrained_edges += u64::from(slab.constrain(h));
                    slab.destination(h)
                }
                First::Crossed(h) => match along(points, &slab, &mut self.strip, h, at, to) {
                    End::Constrained => return Err(CpuError::Crossing { constraint }),
                    End::Lost => return Err(lost("walk")),
                    End::Vertex(v) => {
                        let filled = self.cavity.fill(points, &mut slab, &mut self.half_edges, &self.strip, v);
                        self.counts.flips += filled.ok_or(lost("triangulation of the hole"))?;
                        self.counts.crossed_triangles += self.strip.tris.len() as u64;
                        self.counts.constrained_edges += 1;
                        v
                    }
                },
            };
            if next != to {
                between.push(next);
                if between.len() > points.len() {
                    return Err(lost("row of vertices"));
                }
            }
            at = next;
        }
        self.counts.through_vertices += u64::from(!between.is_empty());
        Ok(between)
    }
}
